"""Comparing two decoded messages, or two JSON documents, field by field.

Decoded means: structs as dicts, arrays as lists or one-dimensional numpy arrays, and as leaves
numbers, truth values, texts, bytes and None. JSON's rules on types hold for all: 1 and 1.0 are both
numbers, true is none.
"""

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.comparison.outcome import EQUAL, Comparison, Differences, Leaf, Tally
from dogbot_logtool.comparison.tolerances import FieldRules, Rules
from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import is_folder, open_file
from dogbot_logtool.io.toml_table import read_text

Tree = Any
"""A decoded value; see above."""
Struct = Mapping[str, Tree]
_QUATERNION: Final = frozenset("xyzw")
_TEXT_LIMIT: Final = 100
_NOTHING: Final = "nothing"
_PROVENANCE: Final = ("tool.version", "log.path")
"""Keys that say where metrics come from."""
_MOST_INTEGERS: Final = 100
"""Elements of an array that are named one by one."""
_LARGEST: Final = 256 << 20


def compare_fields(
    expected: Tree, actual: Tree, rules: FieldRules, path: str = "", name: str | None = None
) -> Iterator[Leaf]:
    """Compare two decoded values; yield what each pair of fields comes to.

    Args:
        expected: the one.
        actual: the other.
        rules: tolerances and ignored fields.
        path: what leads to the values.
        name: the path without positions, if it has any.
    """
    name = path if name is None else name
    if rules.ignored(name):
        return
    if isinstance(expected, dict) and isinstance(actual, dict):
        if _is_quaternion(expected) and _is_quaternion(actual):
            yield from _quaternions(expected, actual, rules, path, name)
        else:
            yield from _structs(expected, actual, rules, path, name)
    elif isinstance(expected, np.ndarray) and isinstance(actual, np.ndarray):
        yield from _arrays(expected, actual, rules, path, name)
    elif isinstance(expected, list) and isinstance(actual, list):
        for row, (one, other) in enumerate(zip(expected, actual, strict=False)):
            yield from compare_fields(one, other, rules, f"{path}[{row}]", name)
        yield from _lengths(len(expected), len(actual), path)
    elif _is_number(expected) and _is_number(actual):
        yield _number(expected, actual, rules, path, name)
    elif type(expected) is type(actual) and expected == actual:
        yield EQUAL
    elif isinstance(expected, bytes) and isinstance(actual, bytes):
        yield _bytes(expected, actual, path)
    else:
        yield Leaf("different", path, text_of(expected), text_of(actual))


def _structs(
    expected: Struct, actual: Struct, rules: FieldRules, path: str, name: str
) -> Iterator[Leaf]:
    if not (expected or actual):
        yield EQUAL
    for key in dict.fromkeys((*expected, *actual)):
        below, inner = join(path, key), join(name, key)
        if key in expected and key in actual:
            yield from compare_fields(expected[key], actual[key], rules, below, inner)
        elif not rules.ignored(inner) and key in expected:
            yield Leaf("missing", below, text_of(expected[key]), _NOTHING)
        elif not rules.ignored(inner):
            yield Leaf("extra", below, _NOTHING, text_of(actual[key]))


def _quaternions(
    expected: Struct, actual: Struct, rules: FieldRules, path: str, name: str
) -> Iterator[Leaf]:
    """Compare rotations: q and -q are the same, and the sign that fits better is taken."""
    if not sum(expected[key] * actual[key] for key in expected) < 0.0:
        yield from _structs(expected, actual, rules, path, name)
        return
    leaves = [*_structs(expected, {k: -v for k, v in actual.items()}, rules, path, name)]
    if any(leaf.outcome == "different" for leaf in leaves):
        # As a whole: single components of q against -q would puzzle.
        deviation = max(leaf.deviation for leaf in leaves if not leaf.deviation >= math.inf)
        yield Leaf("different", path, text_of(expected), text_of(actual), deviation)
    else:
        yield from (leaf._replace(outcome="within_tolerance") for leaf in leaves)


def _arrays(
    expected: NDArray[Any], actual: NDArray[Any], rules: FieldRules, path: str, name: str
) -> Iterator[Leaf]:
    size = min(len(expected), len(actual))
    rows = np.flatnonzero(expected[:size] != actual[:size])
    more = rows[:0]
    yield Leaf("equal", values=size - len(rows))
    if "f" not in expected.dtype.kind + actual.dtype.kind and not rules.claimed(name):
        # Of an image all may differ: most integers without a tolerance are but counted.
        rows, more = np.split(rows, [_MOST_INTEGERS])
    for row in rows.tolist():
        one, other = expected[row].item(), actual[row].item()
        yield from compare_fields(one, other, rules, f"{path}[{row}]", name)
    if len(more):
        yield Leaf("different", path, f"{len(more)} more elements", "others", values=len(more))
    yield from _lengths(len(expected), len(actual), path)


def _lengths(expected: int, actual: int, path: str) -> Iterator[Leaf]:
    if more := expected - actual:
        texts = f"{expected} elements", f"{actual} elements"
        yield Leaf("missing" if more > 0 else "extra", path, *texts, values=abs(more))
    elif not expected:
        yield EQUAL


def _number(expected: float, actual: float, rules: FieldRules, path: str, name: str) -> Leaf:
    if expected == actual or (expected != expected and actual != actual):  # noqa: PLR0124
        return EQUAL
    texts = text_of(expected), text_of(actual)
    tolerance = rules.claimed(name)
    if isinstance(expected, float) or isinstance(actual, float):
        expected, actual = _as_float(expected), _as_float(actual)
        tolerance = tolerance or rules.default
    if tolerance is None:
        return Leaf("different", path, *texts)
    apart = abs(expected - actual)
    allowed = tolerance.atol
    if tolerance.rtol:
        allowed += tolerance.rtol * _as_float(abs(expected))
    # An infinite expected value would allow everything.
    is_near = apart <= allowed and apart < math.inf
    return Leaf("within_tolerance" if is_near else "different", path, *texts, _as_float(apart))


def _bytes(expected: bytes, actual: bytes, path: str) -> Leaf:
    if len(expected) != len(actual):
        return Leaf("different", path, f"{len(expected)} bytes", f"{len(actual)} bytes")
    pairs = enumerate(zip(expected, actual, strict=True))
    index, (one, other) = next(pair for pair in pairs if pair[1][0] != pair[1][1])
    return Leaf("different", f"{path}[{index}]", f"0x{one:02x}", f"0x{other:02x}")


def join(path: str, key: str) -> str:
    """Return the path of a struct's field."""
    return f"{path}.{key}" if path else key


def _as_float(value: float) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _is_number(value: Tree) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_quaternion(value: Struct) -> bool:
    return value.keys() == _QUATERNION and all(isinstance(each, float) for each in value.values())


def text_of(value: Tree) -> str:
    """Return a value in one line that fits a report, without control characters."""
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, bytes):
        text = f"{len(value)} bytes {value[:_TEXT_LIMIT].hex()}"
    elif isinstance(value, np.ndarray):
        text = f"[{', '.join(map(str, value[:_TEXT_LIMIT]))}]"
    else:
        text = json.dumps(value[:_TEXT_LIMIT] if isinstance(value, str) else value, default=text_of)
    return text if len(text) <= _TEXT_LIMIT else f"{text[: _TEXT_LIMIT - 3]}..."


def looks_like_json(path: Path) -> bool:
    """Tell by its first character whether a file is JSON text; a directory is not.

    Raises:
        CallError: there is no such file, or it cannot be opened.
    """
    if is_folder(path):
        return False
    with open_file(path) as file:
        return file.read(64).removeprefix(b"\xef\xbb\xbf").lstrip()[:1] in {b"{", b"["}


def compare_json(expected: Path, actual: Path, rules: Rules, max_differences: int) -> Comparison:
    """Compare two JSON documents; what counts as a topic is a key at the top.

    Raises:
        CallError: none of the keys is wanted.
        LogError: one of the files is not JSON.
    """
    found = Differences(max_differences)
    tallies: list[Tally] = []
    for_values = rules.ignoring(*_PROVENANCE)
    try:
        for key, one, other in _parts(load_json(expected), load_json(actual)):
            if rules.takes(key):
                tallies.append(Tally(key))
                for leaf in compare_fields(one, other, FieldRules(for_values, key)):
                    tallies[-1].add(leaf)
                    found.add(leaf, topic=key)
    except RecursionError as error:
        raise LogError(f"{actual}: is nested too deeply") from error
    if all(each.same and not each.both for each in tallies):
        rules.refuse_nothing("value")
    return Comparison(expected, actual, "values", tallies, found.kept, found.count)


def _parts(expected: Tree, actual: Tree) -> list[tuple[str, Tree, Tree]]:
    """Return the documents' parts with their names; a document that is no object is one part."""
    if not isinstance(expected, dict) or not isinstance(actual, dict):
        return [("(document)", expected, actual)]
    one, other = ({key: {key: part} for key, part in each.items()} for each in (expected, actual))
    return [(key, one.get(key, {}), other.get(key, {})) for key in one | other]


def load_json(path: Path) -> Tree:
    """Read a JSON document.

    Raises:
        CallError: it cannot be read.
        LogError: it is not JSON.
    """
    try:
        return json.loads(read_text(path, "statistics", _LARGEST))
    except RecursionError as error:
        raise LogError(f"{path}: is nested too deeply") from error
    except ValueError as error:
        # Of a number with too many digits, Python says behind the semicolon how it would take them.
        why = str(error).partition(";")[0]
        raise LogError(f"{path}: is not JSON that can be read: {why}") from error
