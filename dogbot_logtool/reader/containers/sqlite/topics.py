"""The tables of a .db3 file that describe its topics and message types."""

from collections.abc import Iterable, Mapping
from operator import itemgetter
from typing import Any, Final

from zlib_ng.zlib_ng import crc32

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import Location, shown
from dogbot_logtool.reader.containers.contents import Channel, ChannelIds, Schema
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.sqlite.database import Database
from dogbot_logtool.reader.decode.known_definitions import known_definition, long_type_name

_MOST_TOPICS: Final = 0xFFFF
"""Channel ids of an MCAP."""
_NEEDED: Final = {
    "topics": {"id", "name", "type"},
    "messages": {"topic_id", "timestamp", "data"},
}
_DEFINITIONS: Final = "message_definitions"
_SCHEMA: Final = "schema"
"""Tables of newer recorders."""
TABLES: Final = (*_NEEDED, _DEFINITIONS, _SCHEMA)


@dataclass(frozen=True, slots=True)
class Topics:
    """The topics of a database."""

    channels: Mapping[int, Channel]
    ids: ChannelIds
    """Channels by topic id."""
    losses: tuple[Loss, ...] = ()
    """Facts that the tables hold twice."""


def check_tables(database: Database, path: Location) -> None:
    """Check that the tables are those of a ROS 2 bag.

    Raises:
        LogError: they are not, or they are damaged.
    """
    for name, needed in _NEEDED.items():
        table = database.tables.get(name)
        if table is None:
            met = database.damage.loss(database.pages.size, (None, None))
            what = f"but no ROS 2 bag: no table {name!r}" if met is None else f"but {met.what}"
            raise LogError(f"{shown(path)}: is a SQLite database, {what}")
        if missing := needed - table.columns.keys():
            why = f"its table {name!r} has no {min(missing)!r}"
            raise LogError(f"{shown(path)}: is no ROS 2 bag: {why}")
        if not table.has_rowids:
            why = f"the rows of its table {name!r} have no numbers"
            raise LogError(f"{shown(path)}: is no ROS 2 bag: {why}")


def read_topics(database: Database, distribution: str) -> Topics:
    """Read the topics, and find the definitions of their types: the log's own go first."""
    losses: list[Loss] = []
    recorded = _recorded_definitions(database, losses)
    distribution = _distribution(database) or distribution
    names = ("id", "name", "type", "serialization_format", "offered_qos_profiles")
    found = [
        (number, name, kind, "cdr" if serialisation is None else str(serialisation), profiles)
        for number, name, kind, serialisation, profiles in database.rows("topics", names)
        if isinstance(number, int) and isinstance(name, str) and isinstance(kind, str)
    ]
    found.sort(key=itemgetter(0))
    rows = _each_once(found[:_MOST_TOPICS], losses)
    schemas: dict[str, Schema] = {}
    channels: dict[int, Channel] = {}
    for number, (_, name, type_name, serialisation, profiles) in enumerate(rows, start=1):
        kind = long_type_name(type_name)
        if kind not in schemas:
            encoding, text = recorded.get(kind) or _known(kind, distribution)
            schemas[kind] = Schema(len(schemas) + 1, kind, encoding, text.encode())
        metadata = {"offered_qos_profiles": str(profiles)} if profiles else {}
        channels[number] = Channel(number, name, serialisation, schemas[kind], metadata)
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
    rows = database.rows(_DEFINITIONS, ("topic_type", "encoding", "encoded_message_definition"))
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
    rows = database.rows(_SCHEMA, ("ros_distro",))
    return next((name for (name,) in rows if isinstance(name, str)), "")
