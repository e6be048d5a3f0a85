"""Every type of message: harmed ones leave others alone, other definitions are read or refused."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Final

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dogbot_logtool.reader.containers.log import Batch, Channel, Messages, Schema
from dogbot_logtool.reader.decode.paths import MOST_ELEMENTS
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.bases import read_base
from dogbot_logtool.reader.messages.contacts import read_contacts
from dogbot_logtool.reader.messages.feet import FootChannels, feet_in
from dogbot_logtool.reader.messages.messages import malformed_in
from dogbot_logtool.reader.messages.source import Source, Topic, source_of
from tests.oracles import base_walks, state_walks, walks

KINDS_OF_FEET = (*walks.KINDS, *state_walks.KINDS, "sensor_msgs/msg/JointState")
FEET: Final = tuple(kind.replace("/msg/", "/") for kind in KINDS_OF_FEET)
POSES: Final = tuple(name for name in base_walks.TOPICS if name not in FEET)
OBJECTS: Final = tuple(name for name in POSES if name.startswith("foxglove."))
"""Types whose definitions do not stand in the log."""
DECODED: Final = tuple(name for name in (*FEET, *POSES) if name not in OBJECTS)
LABELS: Final = {"syropod_highlevel_controller": state_walks.TIPS}
LABELS["hrpsys_ros_bridge"] = state_walks.SENSORS
"""What messages call the feet, by their package."""
COUNT: Final = 12
TIMES: Final = walks.START + np.arange(COUNT) * walks.STEP
WALK: Final = state_walks.StateWalk(2)


def kind_of(type_name: str) -> str:
    return type_name.replace("/", "/msg/")


def definition(type_name: str) -> str:
    if type_name in POSES:
        return base_walks.definition(type_name)
    return WALK.definition(kind_of(type_name))


@cache
def payloads(type_name: str) -> tuple[bytes, ...]:
    """Return sound messages; feet are in contact in some of them."""
    samples = range(20, 20 + COUNT)
    if type_name in POSES:
        return tuple(base_walks.message(type_name, sample) for sample in samples)
    kind = kind_of(type_name)
    first = [next(iter(WALK.contacts(kind, sample)))[1] for sample in samples]
    return tuple(WALK.bytes_of(kind, message) for message in first)


def channel(type_name: str, text: str | None = None) -> Channel:
    """Return a channel of a type; the text is its definition, if not the usual one."""
    if type_name in OBJECTS:
        return Channel(1, "/topic", "protobuf", Schema(1, type_name, "protobuf", b""), {})
    data = (definition(type_name) if text is None else text).encode()
    return Channel(1, "/topic/joint_foot", "cdr", Schema(1, type_name, "ros2msg", data), {})


def source(of: Channel) -> Source | None:
    return source_of(of, "base" if of.type_name in POSES else "feet")


def read(of: Channel, messages: list[bytes]) -> tuple[list[int], dict[int, int]]:
    """Read messages that were recorded every 10 ms.

    Returns:
        the times of what was read, a row a foot, and malformed messages by channel.
    """
    end = np.cumsum([len(data) for data in messages], dtype=np.int64)
    start, time = np.append(0, end)[:-1], TIMES[: len(messages)]
    columns = Messages(0 * time + 1, time, time, 0 * time, start, end)
    batch = Batch(np.frombuffer(b"".join(messages), np.uint8), columns, ())
    package, _, _ = of.type_name.partition("/")
    if of.type_name in POSES:
        how = source(of)
        assert how
        element = base_walks.ELEMENTS.get(of.type_name, "")
        poses = read_base(Topic(how, (of,), element), batch)
        times = [each.poses.log_time for each in poses]
    else:
        labels = LABELS.get(package, state_walks.LABELS)
        feet = [
            replace(Foot(leg, "/"), element=row, newtons_per_count=1.0, label=labels.get(leg, ""))
            for row, leg in enumerate(walks.LEGS)
        ]
        found = read_contacts(batch, FootChannels(feet, {of: (0, 1, 2, 3)}))
        for each in found:
            assert (
                each.source.row.pairs or len(feet_in(each.source, each.messages)) <= MOST_ELEMENTS
            )
        times = [each.samples.log_time for each in found]
    return [time for own in times for time in own.tolist()], malformed_in(batch)


DAMAGES: Final[dict[str, Callable[[bytes], bytes]]] = {
    "empty": lambda _: b"",
    "cut": lambda data: data[: len(data) // 2],
    "garbage": lambda data: b"\xff" * len(data),
    "too long": lambda data: data + b"\x07" * 9,
}


HARMED: Final = [
    (type_name, damage)
    for type_name in (*FEET, *POSES)
    for damage in DAMAGES
    # Protobuf has no fixed form: an empty message is a sound one.
    if damage != "empty" or type_name not in OBJECTS
]


@pytest.mark.parametrize(("type_name", "damage"), HARMED)
def test_malformed_messages_leave_their_neighbours_alone(type_name: str, damage: str) -> None:
    of, sound = channel(type_name), list(payloads(type_name))
    harmed = [DAMAGES[damage](message) for message in sound]
    whole, malformed = read(of, sound)
    assert (sorted(set(whole)), malformed) == (TIMES.tolist(), {})
    left = [time for time in whole if time not in TIMES[4:7]]
    assert read(of, [*sound[:4], *harmed[4:7], *sound[7:]]) == (left, {1: 3})
    assert read(of, harmed) == ([], {1: COUNT})
    assert read(of, []) == ([], {})


@pytest.mark.parametrize("type_name", FEET)
def test_messages_of_nothing_are_sound(type_name: str) -> None:
    fields = dict(WALK.store.fielddefs[kind_of(type_name)][1])
    frames = {"header": WALK.header(0, "world")} if "header" in fields else {}
    nothing = WALK.bytes_of(kind_of(type_name), WALK.make(type_name, **frames))
    assert read(channel(type_name), [nothing] * COUNT)[1] == {}


SEPARATOR = "=" * 80 + "\n"
KINDS = (
    *("string", "wstring", "bool", "byte", "int8", "uint64", "float32", "float64", "time"),
    *("builtin_interfaces/Time", "std_msgs/Header", "missing_msgs/Missing"),
)
SHAPES = ("", "[]", "[0]", "[2]", "[9]", "[<=3]")
ODOMETRY = "nav_msgs/Odometry"
CONTACTS = "gazebo_msgs/ContactsState"
SPOT = "spot_msgs/FootStateArray"


def sections(type_name: str) -> list[list[str]]:
    """Return the lines of a definition's parts: the type's own, then its dependencies."""
    parts = definition(type_name).split(SEPARATOR)
    return [[line for line in part.splitlines() if line.strip()] for part in parts]


def joined(parts: list[list[str]]) -> str:
    return SEPARATOR.join("\n".join(part) + "\n" for part in parts)


@st.composite
def other_definitions(draw: st.DrawFn, type_name: str) -> str:
    """Draw a definition of the type with a few changes."""
    parts = sections(type_name)
    for _ in range(draw(st.integers(1, 3))):
        part = draw(st.sampled_from(parts))
        rows = [row for row, line in enumerate(part) if not line.startswith("MSG:")]
        if not rows:
            continue
        row = draw(st.sampled_from(rows))
        kind, _, name = part[row].partition(" ")
        other = draw(st.sampled_from(KINDS)) + draw(st.sampled_from(SHAPES))
        match draw(st.sampled_from(("kind", "shape", "twice", "gone", "last", "name", "constant"))):
            case "kind":
                part[row] = f"{other} {name}"
            case "shape":
                part[row] = f"{kind.partition('[')[0]}{draw(st.sampled_from(SHAPES))} {name}"
            case "twice":
                part.append(draw(st.sampled_from((part[row], f"{other} {name}"))))
            case "gone":
                del part[row]
            case "last":
                part.append(part.pop(row))
            case "name":
                part[row] = f"{kind} other_{name}"
            case "constant":
                part[row] = f"int32 {name}=1"
    return joined(parts)


@pytest.mark.parametrize("type_name", DECODED)
@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)
@given(st.data())
def test_other_definitions_give_columns_or_a_sentence(type_name: str, data: st.DataObject) -> None:
    of = channel(type_name, data.draw(other_definitions(type_name)))
    how = source(of)
    if how is None:
        # Known by its fields alone, it is another type now.
        assert type_name.startswith(("old_", "my_driver"))
        return
    if how.fault or how.own_definition:
        assert_is_sentence(how.fault or how.own_definition)
    if not how.fault:
        assert sum(read(of, list(payloads(type_name))[:5])[1].values()) <= 5


def fitted(type_name: str, text: str) -> Source:
    how = source(channel(type_name, text))
    assert how
    return how


def assert_is_sentence(text: str) -> None:
    assert 20 < len(text) < 300
    assert "\n" not in text
    assert "Error" not in text


OTHERWISE: Final = {
    "has the field 'i' twice": (ODOMETRY, ("string child_frame_id\n", "bool i\nbool i\n")),
    "position' of nav_msgs/Odometry must be readable as xyz": (ODOMETRY, ("64 x", "64[2] x")),
    # Their types differ from version to version.
    "has no definition of spot_msgs/": (SPOT, (definition(SPOT), "")),
}


@pytest.mark.parametrize("says", OTHERWISE)
def test_what_is_wrong_with_a_definition_is_said(says: str) -> None:
    type_name, change = OTHERWISE[says]
    how = fitted(type_name, definition(type_name).replace(*change))
    assert says in (how.fault or how.own_definition)


@pytest.mark.parametrize("type_name", [ODOMETRY, CONTACTS, "tf2_msgs/TFMessage"])
@pytest.mark.parametrize("text", ["", "%%%"])
def test_our_own_definition_reads_the_same(type_name: str, text: str) -> None:
    messages = list(payloads(type_name))
    assert fitted(type_name, text).own_definition
    assert read(channel(type_name, text), messages) == read(channel(type_name), messages)
