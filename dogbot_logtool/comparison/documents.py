"""Two JSON documents compared value by value: those of ``stats --json``, or any others."""

from pathlib import Path
from typing import Final

from dogbot_logtool.comparison.decoders import parse_json
from dogbot_logtool.comparison.fields import Tree, compare_fields, join
from dogbot_logtool.comparison.outcome import Comparison, Difference, Findings, tally_of_leaves
from dogbot_logtool.comparison.tolerances import FieldRules, Rules, fits, nothing_left
from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.io.storage import content, is_folder, open_file

_PROVENANCE: Final = ("tool.version", "log.path")
"""Keys that say where metrics come from."""
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
    findings = Findings(max_differences)
    tallies, compared = [], 0
    for_values = rules.ignoring(*_PROVENANCE)
    try:
        one, other = (_picked(document, "", rules) for document in documents)
        if one is _NOTHING and other is _NOTHING:
            raise CallError(f"--topics: neither file has a key like {', '.join(rules.topics)}")
        for key, first, second in _parts(one, other):
            if not fits(rules.ignore, key):
                found = Findings(findings.room)
                compare_fields(first, second, FieldRules(for_values, key), found)
                findings.take(found, Difference(topic=key))
                tallies.append(tally_of_leaves(key, found))
                compared += found.compared + found.empty + found.missing + found.extra
    except RecursionError as error:
        raise LogError(f"{actual}: is nested too deeply") from error
    if (rules.ignore or rules.topics) and not compared:
        raise nothing_left(rules, "value")
    return Comparison(expected, actual, "values", tallies, findings.differences, findings.count)


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


def _parts(expected: Tree, actual: Tree) -> list[tuple[str, Tree, Tree]]:
    """Return the documents' parts with their names; a document that is no object is one part."""
    one, other = ({} if each is _NOTHING else each for each in (expected, actual))
    if not isinstance(one, dict) or not isinstance(other, dict):
        return [(_WHOLE, one, other)]
    parts = {key: [{key: e[key]} if key in e else {} for e in (one, other)] for key in one | other}
    return [(key, first, second) for key, (first, second) in parts.items()]


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
