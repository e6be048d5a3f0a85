"""ROS 2 messages whose fields are columns: serialised once by rosbags, then filled row by row."""

import struct
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any, Final

import numpy as np
from mcap.writer import CompressionType
from rosbags.typesys import get_types_from_msg

from tests.oracles.recorded import S
from tests.oracles.walks import Entry, Walk, write_mcap
from tests.truth.geometry import Ints

CONTACTS: Final = "gazebo_msgs/msg/ContactsState"
IMU: Final = "sensor_msgs/msg/Imu"
ODOMETRY: Final = "nav_msgs/msg/Odometry"
SPOT: Final = "spot_msgs/msg/FootStateArray"
TF: Final = "tf2_msgs/msg/TFMessage"
WRENCH: Final = "geometry_msgs/msg/WrenchStamped"
GROUND: Final = "ground_plane::link::collision"
FOOT_STATES: Final = "std_msgs/Header header\nspot_msgs/FootState[] states"
"""As a fork has it: with a header."""
STAMP: Final = (0x5A5A5A5A, 0x3B3B3B3B)
"""s and ns of a stamp that is to be filled."""
STAMP_BYTES: Final = struct.pack("<iI", *STAMP)
FIRST: Final = 1.0e200
"""Number i that is to be filled is i times this."""


@cache
def _ros() -> Walk:
    """Return what makes messages."""
    ros = Walk(2)
    del ros.store.fielddefs[SPOT]
    ros.store.register(get_types_from_msg(FOOT_STATES, SPOT))
    return ros


def header(frame: str = "") -> dict[str, Any]:
    """Return the fields of a header whose stamp is to be filled."""
    return {"stamp": STAMP, "frame_id": frame}


def contact_state(collision: str, force: Any, point: Any, normal: Any, other: str = GROUND) -> Any:
    """Return the fields of a contact of Gazebo classic; the foot is body 1."""
    return {
        "collision1_name": collision,
        "collision2_name": other,
        "wrenches": [[force]],
        "total_wrench": [force],
        "contact_positions": [point],
        "contact_normals": [normal],
        "depths": [0.0],
    }


def transform(parent: str, child: str, place: Any, turn: Any) -> dict[str, Any]:
    """Return the fields of a transform."""
    return {"header": header(parent), "child_frame_id": child, "transform": [place, turn]}


def messages(topic: str, kind: str, stamp: Ints, log_time: Ints, **fields: Any) -> list[Entry]:
    """Return n messages of a topic.

    Args:
        topic: its name.
        kind: their type.
        stamp: (n,) ns, for each field that is `STAMP`.
        log_time: (n,) ns.
        fields: as `Walk.make` takes them. An array is a column, with a row for each message: of
            float64, or of whole numbers and flags of one byte.
    """
    ros, columns = _ros(), list(_columns(fields))
    none, message = (
        np.frombuffer(ros.bytes_of(kind, ros.make(kind, **_row(fields, count(1), flag))), np.uint8)
        for flag in (0, 1)
    )
    data = np.tile(message, (len(stamp), 1))
    _fill(data, message, STAMP_BYTES, np.column_stack(np.divmod(stamp, S)).astype("<u4"))
    numbers = [row for column in columns if column.dtype == np.float64 for row in column.T]
    for number, column in enumerate(numbers, 1):
        _fill(data, message, struct.pack("<d", number * FIRST), column.astype("<f8")[:, None])
    flags = [column for column in columns if column.dtype != np.float64]
    if flags:
        data[:, none != message] = np.concatenate(flags, axis=1)
    rows = (each.tobytes() for each in data)
    return [Entry(topic, kind, *each) for each in zip(log_time.tolist(), rows, strict=True)]


def _columns(value: Any) -> Iterator[Any]:
    """Yield the columns in fields, (n, ...) as (n, k)."""
    if isinstance(value, np.ndarray):
        yield value.reshape(len(value), int(np.prod(value.shape[1:])))
    elif isinstance(value, Mapping | list | tuple):
        for each in value.values() if isinstance(value, Mapping) else value:
            yield from _columns(each)


def _row(value: Any, numbers: Iterator[int], flag: int) -> Any:
    """Return the fields of one message: of columns numbers that tell their place, and a flag."""
    if isinstance(value, Mapping):
        return {name: _row(each, numbers, flag) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_row(each, numbers, flag) for each in value]
    if not isinstance(value, np.ndarray):
        return value
    row = np.full(value.shape[1:], flag)
    if value.dtype == np.float64:
        row = np.array([next(numbers) * FIRST for _ in range(row.size)]).reshape(row.shape)
    return row.tolist()


def _fill(data: Any, message: Any, mark: bytes, values: Any) -> None:
    """Fill values, (n, k), in wherever a message has a mark."""
    places = np.lib.stride_tricks.sliding_window_view(message, len(mark))
    for at in np.flatnonzero((places == np.frombuffer(mark, np.uint8)).all(axis=1)):
        data[:, at : at + len(mark)] = np.ascontiguousarray(values).view(np.uint8)


def write(path: Path, entries: Iterable[Entry]) -> Path:
    """Write messages into an MCAP, in the order of their log times."""
    ordered = sorted(entries, key=lambda each: each.log_time)
    return write_mcap(path, _ros(), ordered, compression=CompressionType.NONE)
