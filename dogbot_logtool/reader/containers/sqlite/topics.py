"""The tables of a .db3 file that describe its topics and message types."""

from collections.abc import Mapping
from typing import Final

from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import Location, name_of
from dogbot_logtool.reader.containers.log import Channel, Schema
from dogbot_logtool.reader.containers.sqlite.pages import Pages
from dogbot_logtool.reader.containers.sqlite.tables import Table, small_rows
from dogbot_logtool.reader.containers.sqlite.tree import Damage
from dogbot_logtool.reader.decode.definition import long_type_name
from dogbot_logtool.reader.decode.known_definitions import known_definition

_LARGEST_ID: Final = 0xFFFF
"""Of a channel of an MCAP; topics are numbered from 1 on."""
_NEEDED: Final = {
    "topics": {"id", "name", "type"},
    "messages": {"topic_id", "timestamp", "data"},
}
_DEFINITIONS: Final = "message_definitions"
_SCHEMA: Final = "schema"
"""Tables of newer recorders."""
TABLES: Final = (*_NEEDED, _DEFINITIONS, _SCHEMA)


def check_tables(tables: Mapping[str, Table], pages: Pages, damage: Damage, path: Location) -> None:
    """Check that the tables are those of a ROS 2 bag.

    Raises:
        LogError: they are not, or they are damaged.
    """
    for name, needed in _NEEDED.items():
        table = tables.get(name)
        if table is None:
            met = damage.loss(pages.size, (None, None))
            what = f"but no ROS 2 bag: no table {name!r}" if met is None else f"but {met.what}"
            raise LogError(f"{name_of(path)}: is a SQLite database, {what}")
        if missing := needed - table.columns.keys():
            why = f"its table {name!r} has no {min(missing)!r}"
            raise LogError(f"{name_of(path)}: is no ROS 2 bag: {why}")


def read_topics(
    tables: Mapping[str, Table], pages: Pages, damage: Damage, distribution: str
) -> dict[int, Channel]:
    """Return the topics; definitions of their types that the log has itself go first."""
    definitions: dict[str, tuple[str, str]] = {}
    names: tuple[str, ...] = ("topic_type", "encoding", "encoded_message_definition")
    for name, encoding, text in small_rows(pages, tables.get(_DEFINITIONS), names, damage):
        if encoding in {"ros2msg", "ros2idl"} and text:
            definitions.setdefault(long_type_name(str(name)), (str(encoding), str(text)))
    for (own,) in small_rows(pages, tables.get(_SCHEMA), ("ros_distro",), damage):
        distribution = own if isinstance(own, str) else distribution
    topics: dict[int, tuple[str, str, str, str]] = {}
    names = ("id", "name", "type", "serialization_format", "offered_qos_profiles")
    for number, name, kind, form, profiles in small_rows(pages, tables["topics"], names, damage):
        if not (isinstance(number, int) and isinstance(name, str) and isinstance(kind, str)):
            continue
        if 0 <= number <= _LARGEST_ID:
            encoding = "cdr" if form is None else str(form)
            topics.setdefault(number, (name, long_type_name(kind), encoding, str(profiles or "")))
    schemas: dict[str, Schema] = {}
    channels: dict[int, Channel] = {}
    for id_, (name, kind, encoding, profiles) in sorted(topics.items()):
        if kind not in schemas:
            known = known_definition(kind, distribution)
            shipped = ("", "") if known is None else ("ros2msg", known)
            form, text = definitions.get(kind, shipped)
            schemas[kind] = Schema(len(schemas) + 1, kind, form, text.encode())
        metadata = {"offered_qos_profiles": profiles} if profiles else {}
        channels[id_] = Channel(id_, name, encoding, schemas[kind], metadata)
    return channels
