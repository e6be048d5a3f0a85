"""The tables of a database: where each begins, and what its columns are called."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from dogbot_logtool.dataclass import dataclass

_TOKEN: Final = re.compile(
    r"""\s+|--[^\n]*|/\*.*?\*/|"(?:[^"]|"")*"|`(?:[^`]|``)*`|\[[^]]*\]|'(?:[^']|'')*'"""
    r"""|[\w$]+|.""",
    re.DOTALL,
)
_BLANK: Final = re.compile(r"\s|--|/\*")
_QUOTES: Final = {'"': '"', "`": "`", "[": "]", "'": "'"}
_LONGEST_SQL: Final = 1 << 14
_MOST_COLUMNS: Final = 256
_CONSTRAINTS: Final = {"CONSTRAINT", "PRIMARY", "UNIQUE", "CHECK", "FOREIGN"}
_COMPUTED: Final = {"AS", "GENERATED"}


@dataclass(frozen=True, slots=True)
class Table:
    """A plain table: nothing in it is computed."""

    root: int
    """Number of its first page."""
    columns: Mapping[str, int]
    """Numbers of its columns in its records, by name in lower case."""
    key: int | None = None
    """Number of the column that is the number of the row, and NULL in the records."""
    has_rowids: bool = True


SCHEMA: Final = Table(1, {"type": 0, "name": 1, "rootpage": 3, "sql": 4})
"""The table of all tables, views and indices."""


def parse_table(sql: str, name: str, root: int) -> Table | None:
    """Parse the SQL of a table as SQLite stores it; None: it is no plain table of that name.

    Args:
        sql: ``CREATE TABLE name (...)``.
        name: in lower case.
        root: number of its first page.
    """
    if len(sql) > _LONGEST_SQL:
        return None
    tokens = [token for token in _TOKEN.findall(sql) if not _BLANK.match(token)]
    words = [token.upper() for token in tokens[:4]]
    if words[:2] != ["CREATE", "TABLE"] or words[3:] != ["("] or _plain(tokens[2]) != name:
        return None
    *parts, options = _parts(tokens[4:])
    if len(parts) > _MOST_COLUMNS:
        return None
    columns: dict[str, int] = {}
    integers: set[str] = set()
    key = ""
    for part in parts:
        words = [word.upper() for word in part]
        if not part or _COMPUTED.intersection(words[1:]):
            return None
        is_column = words[0] not in _CONSTRAINTS
        column = _plain(part[0] if is_column else part[-1].strip("( )"))
        if is_column:
            columns[column] = len(columns)
        if words[1:2] == ["INTEGER"]:
            integers.add(column)
        if "PRIMARY" in words:
            key = column
    has_rowids = "WITHOUT" not in map(str.upper, options)
    return Table(root, columns, columns.get(key) if key in integers else None, has_rowids)


def _parts(words: Sequence[str]) -> Iterator[list[str]]:
    """Yield what stands between the commas of a list, and then what follows the list.

    A list within it is one token.
    """
    part: list[str] = []
    depth = 1
    for index, word in enumerate(words):
        before, depth = depth, depth + (word == "(") - (word == ")")
        if not depth:
            yield part
            yield list(words[index + 1 :])
            return
        if before > 1:
            part[-1] += f" {word}"
        elif word == ",":
            yield part
            part = []
        else:
            part.append(word)
    yield []


def _plain(name: str) -> str:
    """Return a name in lower case, without quotation marks."""
    end = _QUOTES.get(name[:1])
    return (name[1:-1].replace(2 * end, end) if end else name).lower()
