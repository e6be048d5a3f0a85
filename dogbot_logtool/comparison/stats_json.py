"""Two JSON documents compared value by value: those of ``stats --json``, or any others."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from dogbot_logtool.comparison.fields import Findings, Tree, compare_fields, join
from dogbot_logtool.comparison.logs.decoders import parse_json
from dogbot_logtool.comparison.outcome import Comparison, Differences, Kind, Tally
from dogbot_logtool.comparison.tolerances import FieldRules, Rules, fits, nothing_left
from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.io.storage import content, is_folder, open_file

_PROVENANCE: Final = ("tool.version", "log.path")
"""Keys that say where figures come from."""
_WHOLE: Final = "(document)"
_NOTHING: Final = object()
"""Returned by `_picked` for a value that is not wanted."""
_LARGEST: Final = 256 << 20


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
    documents = load_json(expected), load_json(actual)
    differences = Differences(max_differences)
    tallies: list[Tally] = []
    compared: list[int] = []
    for_values = rules.ignoring(*_PROVENANCE)
    try:
        one, other = (_picked(document, "", rules) for document in documents)
        if one is _NOTHING and other is _NOTHING:
            raise CallError(f"--topics: neither file has a key like {', '.join(rules.topics)}")
        for key, parts in _parts(one, other):
            if not fits(rules.ignore, key):
                tally = Tally(key)
                compared.append(_compare_part(tally, *parts, for_values, differences))
                tallies.append(tally)
    except RecursionError as error:
        raise LogError(f"{actual}: is nested too deeply") from error
    if (rules.ignore or rules.topics) and not any(compared):
        raise nothing_left(rules, "value")
    return Comparison(
        expected,
        actual,
        "values",
        tallies,
        differences.kept,
        differences.count,
    )


def _picked(value: Tree, name: str, rules: Rules) -> Tree:
    """Return what of a value is to be compared, `_NOTHING` if nothing is."""
    if not rules.topics or fits(rules.topics, name):
        return value
    if isinstance(value, dict):
        inner = {key: _picked(each, join(name, key), rules) for key, each in value.items()}
        return {key: each for key, each in inner.items() if each is not _NOTHING} or _NOTHING
    if isinstance(value, list):
        elements = [_picked(each, name, rules) for each in value]
        if any(each is not _NOTHING for each in elements):
            # The others keep their positions.
            return [{} if each is _NOTHING else each for each in elements]
    return _NOTHING


def _parts(expected: Tree, actual: Tree) -> Iterator[tuple[str, tuple[Tree, Tree]]]:
    """Yield the documents' parts with their names; a document that is no object is one part."""
    expected, actual = ({} if each is _NOTHING else each for each in (expected, actual))
    if not isinstance(expected, dict) or not isinstance(actual, dict):
        yield _WHOLE, (expected, actual)
        return
    for key in dict.fromkeys((*expected, *actual)):
        one, other = ({key: d[key]} if key in d else {} for d in (expected, actual))
        yield key, (one, other)


def _compare_part(
    tally: Tally, expected: Tree, actual: Tree, rules: Rules, differences: Differences
) -> int:
    """Compare a part; return of how much, empty lists and objects included."""
    findings = Findings(differences.room)
    compare_fields(expected, actual, FieldRules(rules, tally.name), findings)
    tally.count_leaves(findings)
    differences.take(findings, tally.name, Kind.FIELD)
    return findings.compared + findings.empty + findings.missing + findings.extra


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
        return parse_json(data)
    except OSError as error:
        raise CallError(f"{path}: cannot be read: {error.strerror}") from error
    except RecursionError as error:
        raise LogError(f"{path}: is nested too deeply") from error
    except ValueError as error:
        raise LogError(f"{path}: is not JSON that can be read: {error}") from error
