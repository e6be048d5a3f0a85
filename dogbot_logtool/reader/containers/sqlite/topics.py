"""The tables of a .db3 file that describe its topics and message types."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from operator import itemgetter
from typing import Final, TypeVar

from zlib_ng.zlib_ng import crc32

from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import Location, shown
from dogbot_logtool.reader.containers.contents import Channel, ChannelIds, Schema
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.sqlite.database import Database
from dogbot_logtool.reader.decode.definition import long_type_name
from dogbot_logtool.reader.decode.known_definitions import known_definition

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


_Said = TypeVar("_Said")
_More = TypeVar("_More")


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
    own = (name for (name,) in database.rows(_SCHEMA, ("ros_distro",)) if isinstance(name, str))
    distribution = next(own, "") or distribution
    names = ("id", "name", "type", "serialization_format", "offered_qos_profiles")
    found = [
        (number, (name, kind, "cdr" if format_ is None else str(format_)), profiles)
        for number, name, kind, format_, profiles in database.rows("topics", names)
        if isinstance(number, int) and isinstance(name, str) and isinstance(kind, str)
    ]
    found.sort(key=itemgetter(0))
    # A table without a primary key, as hand-made ones are, may have an id several times.
    first = _first_of(
        ((f"topic {number}", said, profiles) for number, said, profiles in found[:_MOST_TOPICS]),
        lambda said: "{} ({}, {})".format(*said),
        losses,
    )
    schemas: dict[str, Schema] = {}
    channels: dict[int, Channel] = {}
    for number, ((name, type_name, encoding), profiles) in enumerate(first.values(), start=1):
        kind = long_type_name(type_name)
        if kind not in schemas:
            known = known_definition(kind, distribution)
            shipped = ("", "") if known is None else ("ros2msg", known)
            form, text = recorded[kind][0] if kind in recorded else shipped
            schemas[kind] = Schema(len(schemas) + 1, kind, form, text.encode())
        metadata = {"offered_qos_profiles": str(profiles)} if profiles else {}
        channels[number] = Channel(number, name, encoding, schemas[kind], metadata)
    ids = {int(what.removeprefix("topic ")): number for number, what in enumerate(first, start=1)}
    return Topics(channels, ChannelIds(ids), tuple(losses))


def _recorded_definitions(
    database: Database, losses: list[Loss]
) -> dict[str, tuple[tuple[str, str], None]]:
    """Return encoding and text by type, as newer recorders write them."""
    rows = database.rows(_DEFINITIONS, ("topic_type", "encoding", "encoded_message_definition"))
    return _first_of(
        (
            (long_type_name(str(name)), (str(encoding), str(text)), None)
            for name, encoding, text in rows
            if encoding in {"ros2msg", "ros2idl"} and text
        ),
        lambda one: f"{crc32(one[1].encode()):08x} ({one[0]}, {len(one[1])} characters)",
        losses,
    )


def _first_of(
    rows: Iterable[tuple[str, _Said, _More]], shown: Callable[[_Said], str], losses: list[Loss]
) -> dict[str, tuple[_Said, _More]]:
    """Return what is said first of each thing; add once what is said differently to the losses."""
    chosen: dict[str, tuple[_Said, _More]] = {}
    contradicted: set[str] = set()
    for what, said, more in rows:
        first = chosen.setdefault(what, (said, more))[0]
        if first != said and what not in contradicted:
            contradicted.add(what)
            text = f"{what} is described in two ways: as {shown(first)} and as {shown(said)}"
            losses.append(Loss(0, f"{text}; the former was used"))
    return chosen
