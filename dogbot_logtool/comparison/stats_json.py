"""Two JSON documents compared value by value: those of ``stats --json``, or any others."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from dogbot_logtool.comparison.fields import Findings, Tree, compare_fields
from dogbot_logtool.comparison.outcome import Comparison, Differences, Kind, Tally
from dogbot_logtool.comparison.tolerances import FieldRules, Rules
from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.storage import content, open_file

_OWN_VERSION: Final = "tool.version"
_WHOLE: Final = "(document)"
_LARGEST: Final = 256 << 20


def looks_like_json(path: Path) -> bool:
    """Tell by its first character whether a file is JSON text; a directory is not.

    Raises:
        CallError: there is no such file, or it cannot be opened.
    """
    if path.is_dir():
        return False
    with open_file(path) as file:
        return file.read(64).removeprefix(b"\xef\xbb\xbf").lstrip()[:1] in {b"{", b"["}


def compare_json(expected: Path, actual: Path, rules: Rules, max_differences: int) -> Comparison:
    """Compare two JSON documents; what counts as a topic is a key at the top.

    Raises:
        CallError: none of the keys is wanted.
        LogError: one of the files is not JSON.
    """
    one, other = _load(expected), _load(actual)
    differences = Differences(max_differences)
    try:
        tallies = [
            _compare_part(key, *parts, rules.ignoring(_OWN_VERSION), differences)
            for key, parts in _parts(one, other)
            if rules.takes(key)
        ]
    except RecursionError as error:
        raise LogError(f"{actual}: is nested too deeply") from error
    if rules.topics and not tallies:
        raise CallError(f"--topics: neither file has a key like {', '.join(rules.topics)}")
    return Comparison(expected, actual, "values", tallies, differences.kept, differences.count)


def _parts(expected: Tree, actual: Tree) -> Iterator[tuple[str, tuple[Tree, Tree]]]:
    """Yield the documents' parts with their names; a document that is no object is one part."""
    if not isinstance(expected, dict) or not isinstance(actual, dict):
        yield _WHOLE, (expected, actual)
        return
    for key in dict.fromkeys((*expected, *actual)):
        one, other = ({key: d[key]} if key in d else {} for d in (expected, actual))
        yield key, (one, other)


def _compare_part(
    name: str, expected: Tree, actual: Tree, rules: Rules, differences: Differences
) -> Tally:
    findings = Findings(differences.room)
    compare_fields(expected, actual, FieldRules(rules, name), findings)
    tally = Tally(name)
    tally.count_leaves(findings)
    differences.take(findings, name, Kind.FIELD)
    return tally


def _load(path: Path) -> Tree:
    try:
        data = content(path, _LARGEST)
        if data is None:
            raise LogError(f"{path}: is larger than any statistics are")
        return json.loads(data)
    except OSError as error:
        raise CallError(f"{path}: cannot be read: {error.strerror}") from error
    except RecursionError as error:
        raise LogError(f"{path}: is nested too deeply") from error
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise LogError(f"{path}: is not JSON: {error}") from error
    except ValueError as error:
        raise LogError(f"{path}: holds a number of too many digits") from error
