"""Small logs of messages made one by one, as bags and MCAP files, and the beginnings of bags."""

import math
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from mcap.writer import CompressionType
from rosbags.rosbag1 import Reader as BagReader
from rosbags.rosbag1 import Writer as BagWriter

from tests.oracles import base_walks, walks
from tests.oracles.recorded import (
    CONTACTS_TYPE,
    ODOMETRY,
    ODOMETRY_TYPE,
    TEXT_TYPE,
    TF_TYPE,
    S,
    contact_topic,
)
from tests.oracles.walks import Entry

WALK = walks.Walk(1)
START: Final = 10 * S
"""ns."""


def encoded(kind: str, **fields: Any) -> bytes:
    """Return the bytes of a message; see `walks.Walk.make`."""
    return WALK.bytes_of(kind, WALK.make(kind, **fields))


def header(time: int, frame: str = "world") -> dict[str, Any]:
    return {"stamp": divmod(time, S), "frame_id": frame}


def odometry(time: int, position: tuple[float, float, float] = (0.0, 0.0, 0.5)) -> bytes:
    pose = [{"position": position}]
    return encoded(ODOMETRY_TYPE, header=header(time), child_frame_id="base_link", pose=pose)


def contact(
    force: tuple[float, float, float],
    foot: str = "front_left",
    points: tuple[tuple[float, float, float], ...] = ((1.0, 2.0, 0.0),),
    info: str = "Debug:  i:(0/1)     my geom:a   other geom:b         time:1.000000000\n",
) -> dict[str, Any]:
    return {
        "info": info,
        "collision1_name": f"dogbot::{foot}_lowerleg::{foot}_foot_collision",
        "collision2_name": "ground_plane::link::collision",
        "wrenches": [[force]] * len(points),
        "total_wrench": [force],
        "contact_positions": points,
        "contact_normals": [(0.0, 0.0, 1.0)] * len(points),
        "depths": np.zeros(len(points)),
    }


def contacts(time: int, *states: dict[str, Any]) -> bytes:
    return encoded(CONTACTS_TYPE, header=header(time), states=states)


def transform(time: int, parent: str, child: str) -> bytes:
    one = {"header": header(time, parent), "child_frame_id": child}
    return encoded(TF_TYPE, transforms=[one])


def text(content: str) -> bytes:
    return encoded(TEXT_TYPE, data=content)


def write_bag(
    path: Path, entries: Iterable[Entry], *, chunk_size: int = 1 << 19, compression: str = ""
) -> Path:
    return walks.write_bag(path, WALK, entries, chunk_size, compression)


def write_ros1_mcap(
    path: Path,
    entries: Iterable[Entry],
    *,
    extras: bool = False,
    compression: CompressionType = CompressionType.LZ4,
    chunk_size: int = 1 << 18,
) -> Path:
    return walks.write_mcap(path, WALK, entries, chunk_size, compression, extras=extras)


def small_walk(seconds: float = 1.0) -> Iterator[Entry]:
    """Yield odometry at 250 Hz, and a front left foot that presses harder and harder."""
    for index in range(round(seconds * 250)):
        time = START + index * 4_000_000
        yield Entry(ODOMETRY, ODOMETRY_TYPE, time, odometry(time, (index / 250, 0.0, 0.5)))
        states = [] if index % 50 < 10 else [contact((0.0, 3.0, 1.0 + index))]
        yield Entry(
            contact_topic("front_left"), CONTACTS_TYPE, time + 1000, contacts(time, *states)
        )


BOUNDS_NM = (380, 440, 490, 510, 580, 645, 750)


def odd_forces() -> Iterator[tuple[float, float, float]]:
    """Yield forces on and beside every bound of the colours, and those that are no numbers."""
    for bound in BOUNDS_NM:
        p = (bound - 380) / 370 * 2.0 * 100.0
        for force in (math.nextafter(p, 0.0), p, math.nextafter(p, math.inf)):
            yield 0.0, 0.0, force
    yield 0.0, 0.0, 200.0000001
    yield 0.0, -0.0, 0.0
    for odd in (math.nan, math.inf, -math.inf):
        yield odd, 1.0, 2.0
        yield 1.0, odd, math.nan
    yield 1e200, 1.0, 1.0
    yield 1e154, 1e154, 1e154
    yield 1e-200, 0.0, 0.0
    rng = np.random.default_rng(3)
    yield from rng.normal(0, 90, (1500, 3)).tolist()
    # Their colours lie as near as can be halfway between two float32 numbers.
    stored = rng.uniform(0.05, 1, 800).astype(np.float32)
    halfway = (stored.astype(np.float64) + np.nextafter(stored, np.float32(2))) / 2
    for wavelength in (510 + (580 - 510) * halfway**1.25).tolist():
        yield 0.0, 0.0, (wavelength - 380) / 370 * 2.0 * 100.0


def odd_contacts() -> Iterator[Entry]:
    topic = contact_topic("front_left")
    time = START
    for force in odd_forces():
        time += 1_000_000
        yield Entry(topic, CONTACTS_TYPE, time, contacts(time, contact(force)))
    one, other = contact((0.0, 0.0, 70.0)), contact((1.0, 2.0, 30.0), points=((5.0, 5.0, 0.0),))
    bare = contact((1.0, 2.0, 3.0), points=())
    for states in ((one, other), (other, one), (bare, one), (), (bare,)):
        time += 1_000_000
        yield Entry(topic, CONTACTS_TYPE, time, contacts(time, *states))


def mixed_contacts() -> Iterator[Entry]:
    """Yield messages of several states: of either side or of others, of two physics steps."""
    rng, topic = np.random.default_rng(11), contact_topic("front_left")
    for number in range(400):
        time = START + number * 10_000_000
        states = [_mixed(rng, time) for _ in range(rng.integers(4))]
        yield Entry(topic, CONTACTS_TYPE, time, contacts(time, *states))


def _mixed(rng: np.random.Generator, time: int) -> dict[str, Any]:
    points = rng.uniform(-5.0, 5.0, (rng.integers(4), 3))
    count = len(points) if rng.random() < 0.7 else rng.integers(5)
    forces = rng.normal(0.0, 90.0, (count, 3)) * (rng.random() < 0.8)
    foot = "front_left" if rng.random() < 0.8 else "back_left"
    info = f"my geom:a   other geom:b         time:{time / S - rng.integers(2):.9f}\n"
    state = contact(tuple(rng.normal(0.0, 90.0, 3)), foot, tuple(map(tuple, points)), info)
    if rng.random() < 0.3:
        swapped = state["collision2_name"], state["collision1_name"]
        state |= dict(zip(("collision1_name", "collision2_name"), swapped, strict=True))
    if rng.random() < 0.1:
        state["total_wrench"] = [(np.nan, 0.0, np.inf)]
    normals = rng.normal(0.0, 1.0, (rng.integers(4), 3))
    return {**state, "wrenches": [[force] for force in forces], "contact_normals": list(normals)}


BASE: Final = (1.0, 2.0, 0.5)
"""m, place of the standing robot's base in the world; it is not turned."""
FEET: Final = {
    "front_left": (0.3, 0.2, -0.5),
    "front_right": (0.3, -0.2, -0.5),
    "back_left": (-0.3, 0.2, -0.5),
    "back_right": (-0.3, -0.2, -0.5),
}
"""m, from the base: +x is forward."""
LIFTED: Final = "back_right"
LIFTED_S: Final = (0.4, 0.8)
"""s after the start."""


def write_standing_log(
    path: Path,
    base: tuple[float, float, float] = BASE,
    newtons: Mapping[str, float] = MappingProxyType({}),
    ends_s: Mapping[str, float] = MappingProxyType({}),
) -> Path:
    """Write a second of a robot that stands, and lifts a foot for a while; it has no transforms.

    Args:
        path: the file.
        base: m, in the world.
        newtons: on feet that carry more or less than 50 N.
        ends_s: when sensors fall silent.
    """
    entries = []
    for index in range(100):
        time, seconds = START + index * S // 100, index / 100
        entries.append(Entry(ODOMETRY, ODOMETRY_TYPE, time, odometry(time, base)))
        for foot, offset in FEET.items():
            x, y, z = (a + b for a, b in zip(BASE, offset, strict=True))
            lifted = foot == LIFTED and LIFTED_S[0] <= seconds < LIFTED_S[1]
            touch = contact((0.0, 0.0, newtons.get(foot, 50.0)), foot, ((x, y, z),))
            data = contacts(time, *([] if lifted else [touch]))
            if seconds < ends_s.get(foot, 2.0):
                entries.append(Entry(contact_topic(foot), CONTACTS_TYPE, time, data))
    return write_ros1_mcap(path, entries)


def odometry_log(path: Path, topic: str, *, filler: int = 0, cut: int = 0) -> Path:
    """Write an MCAP of ten poses, megabytes of noise behind each, the last one cut short."""
    noise, entries = os.urandom(1 << 20), []
    for number in range(10):
        time = (5 + number) * S
        data = odometry(time, (number, 0.0, 0.0))
        kept = len(data) - cut if number == 9 else len(data)
        entries.append(Entry(topic, ODOMETRY_TYPE, time, data[:kept]))
        entries += [Entry("/noise", TEXT_TYPE, time, noise)] * filler
    return write_ros1_mcap(path, entries, compression=CompressionType.NONE, chunk_size=1 << 19)


_FOLDER = tempfile.TemporaryDirectory(prefix="small_logs")
_CHUNK_BYTES = 250_000


@cache
def first_seconds(bag: Path, seconds: float = 2.0) -> Path:
    """Write the first seconds of a bag, without compression, into a file of the same name."""
    path = Path(_FOLDER.name) / f"{seconds:g}" / bag.name
    path.parent.mkdir(exist_ok=True)
    with BagReader(bag) as reader, BagWriter(path) as writer:
        writer.chunk_threshold = _CHUNK_BYTES
        begin = reader.start_time
        added = {
            (c.topic, c.msgtype): writer.add_connection(
                c.topic, c.msgtype, msgdef=c.msgdef.data, md5sum=c.digest
            )
            for c in reader.connections
        }
        for c, time, data in reader.messages(stop=begin + round(seconds * 1e9)):
            writer.write(added[c.topic, c.msgtype], time, data)
    return path


WRENCH, CONTACTS = "geometry_msgs/msg/WrenchStamped", "gazebo_msgs/msg/ContactsState"
MODELS = "gazebo_msgs/msg/ModelStates"
LATE = 40
"""Samples by which every other foot is later."""


def write_log(
    path: Path,
    topics: Mapping[str, str],
    *,
    odometry: Sequence[str] = (),
    models: Mapping[str, float] | None = None,
    samples: int = 3,
) -> Path:
    """Write an MCAP with topics of contact messages, by type; feet take turns.

    Args:
        path: the file.
        topics: type by topic.
        odometry: topics of odometry.
        models: speed of each model of `/gazebo/model_states`, m a sample; None: no such topic.
        samples: how many.
    """
    walk = base_walks.WALK
    entries = []
    for sample in range(samples):
        time = walks.START + sample * walks.STEP
        data = walk.odometry(sample)
        entries += [walks.Entry(one, "nav_msgs/msg/Odometry", time, data) for one in odometry]
        if models is not None:
            listed = base_walks.models(walk, {name: v * sample for name, v in models.items()})
            entries.append(walks.Entry("/gazebo/model_states", MODELS, time, listed))
        for number, (topic, kind) in enumerate(topics.items()):
            down = (sample - number % 2 * LATE) % walks.PERIOD < walks.STANCE
            force = (0.0, 0.0, 60.0 if down else 0.0)
            header = walk.header(sample, "world")
            if kind == WRENCH:
                message = walk.make(kind, header=header, wrench=[force])
            else:
                states = [walk.classic_state("foot", force)] if down else []
                message = walk.make(kind, header=header, states=states)
            entries.append(walks.Entry(topic, kind, time, walk.bytes_of(kind, message)))
    return walks.write_mcap(path, walk, entries)
