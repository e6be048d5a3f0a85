"""The tables of a .db3 file that tell what its messages are."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Ints
from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader.containers.log import Channel, Schema
from dogbot_logtool.reader.containers.sqlite.database import Database
from dogbot_logtool.reader.decode.known_definitions import (
    known_definition,
    long_type_name,
)

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
    ids: Ints
    """(t,) topic ids, sorted."""
    numbers: Ints
    """(t,) the channel of each."""

    def channel_of(self, topic: Ints) -> Ints:
        """(n,) channel ids of topic ids; 0: not described."""
        if not len(self.ids):
            return np.zeros(len(topic), np.int64)
        place = np.minimum(np.searchsorted(self.ids, topic), len(self.ids) - 1)
        return np.where(self.ids[place] == topic, self.numbers[place], 0)


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
    recorded = _recorded_definitions(database)
    distribution = _distribution(database) or distribution
    # Columns that the first recorders did not write yet.
    later = {"serialization_format": "'cdr'", "offered_qos_profiles": "''"}
    present = database.columns("topics")
    columns = ", ".join(
        f"coalesce({column}, {default})" if column in present else default
        for column, default in later.items()
    )
    rows = database.rows(
        f"SELECT id, name, type, {columns} FROM topics "  # noqa: S608
        "WHERE typeof(id) = 'integer' AND typeof(name) = 'text' AND typeof(type) = 'text' "
        "ORDER BY id LIMIT ?",
        (_MOST_TOPICS,),
    )
    schemas: dict[str, Schema] = {}
    channels: dict[int, Channel] = {}
    for number, (_, name, type_name, serialisation, profiles) in enumerate(rows, start=1):
        kind = long_type_name(str(type_name))
        if kind not in schemas:
            encoding, text = recorded.get(kind) or _known(kind, distribution)
            schemas[kind] = Schema(len(schemas) + 1, kind, encoding, text.encode())
        metadata = {"offered_qos_profiles": str(profiles)} if profiles else {}
        channels[number] = Channel(number, str(name), str(serialisation), schemas[kind], metadata)
    ids = np.array([row[0] for row in rows], np.int64)
    return Topics(channels, ids, np.arange(1, len(rows) + 1))


def _known(kind: str, distribution: str) -> tuple[str, str]:
    text = known_definition(kind, distribution)
    return ("", "") if text is None else ("ros2msg", text)


def _recorded_definitions(database: Database) -> dict[str, tuple[str, str]]:
    """Return encoding and text by type, as newer recorders write them."""
    needed = ("topic_type", "encoding", "encoded_message_definition")
    if not database.columns("message_definitions").issuperset(needed):
        return {}
    rows = database.rows(f"SELECT {', '.join(needed)} FROM message_definitions")  # noqa: S608
    return {
        long_type_name(str(kind)): (str(encoding), str(text))
        for kind, encoding, text in rows
        if encoding in {"ros2msg", "ros2idl"} and text
    }


def _distribution(database: Database) -> str:
    if "ros_distro" not in database.columns("schema"):
        return ""
    rows = database.rows("SELECT ros_distro FROM schema WHERE typeof(ros_distro) = 'text' LIMIT 1")
    return str(rows[0][0]) if rows else ""
