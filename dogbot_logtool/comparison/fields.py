"""Comparing two decoded messages, or two JSON documents, field by field.

Decoded means: structs as dicts, arrays as lists or one-dimensional numpy arrays, and as leaves
numbers, truth values, texts, bytes and None. JSON's rules on types hold for all: 1 and 1.0 are both
numbers, true is none.
"""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.comparison.outcome import Comparison, Difference, Findings, Tally
from dogbot_logtool.comparison.tolerances import FieldRules, Rules, fits, nothing_left
from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.io.storage import content, is_folder, open_file

Tree = Any
"""A decoded value; see above."""
Struct = Mapping[str, Tree]
_QUATERNION: Final = frozenset("xyzw")
_TEXT_LIMIT: Final = 100
_NOTHING: Final = "nothing"
_PROVENANCE: Final = ("tool.version", "log.path")
"""Keys that say where metrics come from."""
_WHOLE: Final = "(document)"
_LARGEST: Final = 256 << 20


def compare_fields(
    expected: Tree, actual: Tree, rules: FieldRules, findings: Findings, path: str = ""
) -> Findings:
    """Compare two decoded values.

    Args:
        expected: the one.
        actual: the other.
        rules: tolerances and ignored fields.
        findings: where to note what is found; it is returned.
        path: what leads to the values; without positions.
    """
    _Comparer(rules, findings).compare(expected, actual, path, path)
    return findings


class _Comparer:
    """Walks down both values at once; `path` has positions, `name` has not."""

    def __init__(self, rules: FieldRules, findings: Findings) -> None:
        self._rules = rules
        self._findings = findings
        self._tally = findings.tally

    def compare(self, expected: Tree, actual: Tree, path: str, name: str) -> None:
        if self._rules.ignored(name):
            return
        if isinstance(expected, dict) and isinstance(actual, dict):
            if _is_quaternion(expected) and _is_quaternion(actual):
                self._quaternions(expected, actual, path, name)
            else:
                self.structs(expected, actual, path, name)
        elif isinstance(expected, np.ndarray) and isinstance(actual, np.ndarray):
            self._arrays(expected, actual, path, name)
        elif isinstance(expected, list) and isinstance(actual, list):
            for row, (one, other) in enumerate(zip(expected, actual, strict=False)):
                self.compare(one, other, f"{path}[{row}]", name)
            self._lengths(len(expected), len(actual), path)
        elif _is_number(expected) and _is_number(actual):
            self._numbers(expected, actual, path, name)
        elif type(expected) is type(actual) and expected == actual:
            self._tally.equal += 1
        elif isinstance(expected, bytes) and isinstance(actual, bytes):
            self._bytes(expected, actual, path)
        else:
            self._findings.differ(path, text_of(expected), text_of(actual))

    def structs(self, expected: Struct, actual: Struct, path: str, name: str) -> None:
        self._tally.equal += not (expected or actual)
        for key in dict.fromkeys((*expected, *actual)):
            below, inner = join(path, key), join(name, key)
            if key in expected and key in actual:
                self.compare(expected[key], actual[key], below, inner)
            elif not self._rules.ignored(inner):
                self._tally.missing += key in expected
                self._tally.extra += key in actual
                self._findings.add(below, _text_at(expected, key), _text_at(actual, key))

    def _quaternions(self, expected: Struct, actual: Struct, path: str, name: str) -> None:
        """Compare rotations: q and -q are the same, and the sign that fits better is taken."""
        if not sum(expected[key] * actual[key] for key in expected) < 0.0:
            self.structs(expected, actual, path, name)
            return
        found = Findings(0)
        turned = {key: -value for key, value in actual.items()}
        _Comparer(self._rules, found).structs(expected, turned, path, name)
        self._tally.deviate(found.tally.deviation_path, found.tally.deviation)
        if found.count:
            # As a whole: single components of q against -q would puzzle.
            texts = text_of(expected), text_of(actual)
            self._findings.differ(path, *texts, found.tally.deviation)
        else:
            self._tally.within_tolerance += found.tally.both

    def _arrays(self, expected: NDArray[Any], actual: NDArray[Any], path: str, name: str) -> None:
        size = min(len(expected), len(actual))
        rows = np.flatnonzero(expected[:size] != actual[:size])
        self._tally.equal += size - len(rows)
        if "f" not in expected.dtype.kind + actual.dtype.kind and not self._rules.claimed(name):
            # Of an image all may differ: integers without a tolerance are but counted.
            uncounted = len(rows[self._findings.limit :])
            self._tally.different += uncounted
            self._findings.count += uncounted
            rows = rows[: self._findings.limit]
        for row in rows.tolist():
            self.compare(expected[row].item(), actual[row].item(), f"{path}[{row}]", name)
        self._lengths(len(expected), len(actual), path)

    def _lengths(self, expected: int, actual: int, path: str) -> None:
        self._tally.equal += not (expected or actual)
        if expected != actual:
            self._tally.missing += max(expected - actual, 0)
            self._tally.extra += max(actual - expected, 0)
            self._findings.add(path, f"{expected} elements", f"{actual} elements")

    def _numbers(self, expected: float, actual: float, path: str, name: str) -> None:
        if expected == actual or (expected != expected and actual != actual):  # noqa: PLR0124
            self._tally.equal += 1
            return
        texts = text_of(expected), text_of(actual)
        tolerance = self._rules.claimed(name)
        if isinstance(expected, float) or isinstance(actual, float):
            expected, actual = _as_float(expected), _as_float(actual)
            tolerance = tolerance or self._rules.default
        if tolerance is None:
            self._findings.differ(path, *texts)
            return
        apart = abs(expected - actual)
        allowed = tolerance.atol
        if tolerance.rtol:
            allowed += tolerance.rtol * _as_float(abs(expected))
        self._tally.deviate(path, _as_float(apart))
        # An infinite expected value would allow everything.
        if apart <= allowed and apart < math.inf:
            self._tally.within_tolerance += 1
        else:
            self._findings.differ(path, *texts, _as_float(apart))

    def _bytes(self, expected: bytes, actual: bytes, path: str) -> None:
        if len(expected) != len(actual):
            texts = f"{len(expected)} bytes", f"{len(actual)} bytes"
            self._findings.differ(path, *texts)
            return
        pairs = enumerate(zip(expected, actual, strict=True))
        index, (one, other) = next(pair for pair in pairs if pair[1][0] != pair[1][1])
        self._findings.differ(f"{path}[{index}]", f"0x{one:02x}", f"0x{other:02x}")


def join(path: str, key: str) -> str:
    """Return the path of a struct's field."""
    return f"{path}.{key}" if path else key


def _text_at(value: Struct, key: str) -> str:
    return text_of(value[key]) if key in value else _NOTHING


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
    findings = Findings(max_differences)
    tallies: list[Tally] = []
    for_values = rules.ignoring(*_PROVENANCE)
    parts = _parts(load_json(expected), load_json(actual))
    if rules.topics and not any(fits(rules.topics, key) for key, *_ in parts):
        raise CallError(f"--topics: neither file has a key like {', '.join(rules.topics)}")
    try:
        for key, one, other in parts:
            if rules.takes(key):
                found = findings.within(Difference(topic=key), key)
                findings.take(compare_fields(one, other, FieldRules(for_values, key), found))
                tallies.append(found.tally)
    except RecursionError as error:
        raise LogError(f"{actual}: is nested too deeply") from error
    if (rules.ignore or rules.topics) and all(t.same and not t.both for t in tallies):
        raise nothing_left(rules, "value")
    return Comparison(expected, actual, "values", tallies, findings.differences, findings.count)


def _parts(expected: Tree, actual: Tree) -> list[tuple[str, Tree, Tree]]:
    """Return the documents' parts with their names; a document that is no object is one part."""
    if not isinstance(expected, dict) or not isinstance(actual, dict):
        return [(_WHOLE, expected, actual)]
    one, other = ({key: {key: part} for key, part in each.items()} for each in (expected, actual))
    return [(key, one.get(key, {}), other.get(key, {})) for key in one | other]


def load_json(path: Path) -> Tree:
    """Read a JSON document.

    Raises:
        CallError: it cannot be read.
        LogError: it is not JSON.
    """
    try:
        data = content(path, _LARGEST)
        if data is None:
            raise LogError(f"{path}: is larger than any statistics are")
        return json.loads(data)
    except OSError as error:
        raise CallError(f"{path}: cannot be read: {error.strerror}") from error
    except RecursionError as error:
        raise LogError(f"{path}: is nested too deeply") from error
    except ValueError as error:
        # Of a number with too many digits, Python says behind the semicolon how it would take them.
        why = str(error).partition(";")[0]
        raise LogError(f"{path}: is not JSON that can be read: {why}") from error
