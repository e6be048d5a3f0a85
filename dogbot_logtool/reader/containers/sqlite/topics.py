"""The tables of a .db3 file that describe its topics and message types."""

from collections.abc import Iterable, Mapping
from typing import Any, Final

from zlib_ng.zlib_ng import crc32

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader.containers.channel_ids import ChannelIds
from dogbot_logtool.reader.containers.contents import Channel, Schema
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.sqlite.database import Database
from dogbot_logtool.reader.decode.known_definitions import known_definition, long_type_name

_MOST_TOPICS: Final = 0xFFFF
"""Channel ids of an MCAP."""
_COLUMNS: Final = {
    "topics": {"id", "name", "type"},
    "messages": {"topic_id", "timestamp", "data"},
}


@dataclass(frozen=True, slots=True)
class Topics:
    """The topics of a database."""

    channels: Mapping[int, Channel]
    ids: ChannelIds
    """Channels by topic id."""
    losses: tuple[Loss, ...] = ()
    """Facts that the tables hold twice."""


def check_tables(database: Database, path: Location) -> None:
    """Check that the tables are a ROS 2 bag's, and plain: nothing that computes its rows.

    Raises:
        LogError: they are not.
    """
    for table, needed in _COLUMNS.items():
        columns = database.columns(table)
        if not columns:
            raise LogError(f"{path}: is a SQLite database, but no ROS 2 bag: no table {table!r}")
        if not needed <= columns:
            missing = min(needed - columns)
            raise LogError(f"{path}: is no ROS 2 bag: its table {table!r} has no {missing!r}")


def read_topics(database: Database, distribution: str) -> Topics:
    """Read the topics, and find the definitions of their types: the log's own go first."""
    losses: list[Loss] = []
    recorded = _recorded_definitions(database, losses)
    distribution = _distribution(database) or distribution
    # Columns that the first recorders did not write yet.
    later = {"serialization_format": "'cdr'", "offered_qos_profiles": "''"}
    present = database.columns("topics")
    columns = ", ".join(
        f"coalesce({column}, {default})" if column in present else default
        for column, default in later.items()
    )
    found = database.rows(
        f"SELECT id, name, type, {columns} FROM topics "  # noqa: S608
        "WHERE typeof(id) = 'integer' AND typeof(name) = 'text' AND typeof(type) = 'text' "
        "ORDER BY id LIMIT ?",
        (_MOST_TOPICS,),
    )
    rows = _each_once(found, losses)
    schemas: dict[str, Schema] = {}
    channels: dict[int, Channel] = {}
    for number, (_, name, type_name, serialisation, profiles) in enumerate(rows, start=1):
        kind = long_type_name(str(type_name))
        if kind not in schemas:
            encoding, text = recorded.get(kind) or _known(kind, distribution)
            schemas[kind] = Schema(len(schemas) + 1, kind, encoding, text.encode())
        metadata = {"offered_qos_profiles": str(profiles)} if profiles else {}
        channels[number] = Channel(number, str(name), str(serialisation), schemas[kind], metadata)
    ids = ChannelIds({row[0]: number for number, row in enumerate(rows, start=1)})
    return Topics(channels, ids, tuple(losses))


def _each_once(rows: Iterable[tuple[Any, ...]], losses: list[Loss]) -> list[tuple[Any, ...]]:
    """Return the first row of each topic id; add what others say differently to the losses.

    A table without a primary key, as hand-made ones are, may have an id several times.
    """
    chosen: dict[int, tuple[Any, ...]] = {}
    contradicted: set[int] = set()
    for row in rows:
        first = chosen.setdefault(row[0], row)
        if first[1:4] != row[1:4] and row[0] not in contradicted:
            contradicted.add(row[0])
            losses.append(_said_twice(f"topic {row[0]}", _topic(first), _topic(row)))
    return list(chosen.values())


def _topic(row: tuple[object, ...]) -> str:
    return f"{row[1]} ({row[2]}, {row[3]})"


def _said_twice(what: str, chosen: str, other: str) -> Loss:
    text = f"{what} is described in two ways: as {chosen} and as {other}"
    return Loss(0, f"{text}; the former was used")


def _known(kind: str, distribution: str) -> tuple[str, str]:
    text = known_definition(kind, distribution)
    return ("", "") if text is None else ("ros2msg", text)


def _recorded_definitions(database: Database, losses: list[Loss]) -> dict[str, tuple[str, str]]:
    """Return encoding and text by type, as newer recorders write them.

    The first definition of a type is taken; a definition that differs is a loss.
    """
    needed = ("topic_type", "encoding", "encoded_message_definition")
    if not database.columns("message_definitions").issuperset(needed):
        return {}
    rows = database.rows(f"SELECT {', '.join(needed)} FROM message_definitions")  # noqa: S608
    chosen: dict[str, tuple[str, str]] = {}
    contradicted: set[str] = set()
    for name, encoding, text in rows:
        if encoding not in {"ros2msg", "ros2idl"} or not text:
            continue
        kind, one = long_type_name(str(name)), (str(encoding), str(text))
        first = chosen.setdefault(kind, one)
        if first != one and kind not in contradicted:
            contradicted.add(kind)
            losses.append(_said_twice(kind, _definition(first), _definition(one)))
    return chosen


def _definition(one: tuple[str, str]) -> str:
    encoding, text = one
    return f"{crc32(text.encode()):08x} ({encoding}, {len(text)} characters)"


def _distribution(database: Database) -> str:
    if "ros_distro" not in database.columns("schema"):
        return ""
    rows = database.rows("SELECT ros_distro FROM schema WHERE typeof(ros_distro) = 'text' LIMIT 1")
    return str(rows[0][0]) if rows else ""
