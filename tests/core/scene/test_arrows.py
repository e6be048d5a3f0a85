"""Arrows: classic ones against the live script, to the bit, and the rotation of the others."""

import math
from collections import Counter
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.contact.contacts import FOOT_IS_COLLISION1, Contacts
from dogbot_logtool.core.scene.arrows import classic_arrows, turn_x_to, wavelength_to_rgba
from tests.oracles.conversion import light

Vector = tuple[float, float, float]

INF: Final = math.inf
NAN: Final = math.nan

generated = settings(max_examples=75, deadline=None)


def vectors(rows: list[Vector]) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.array(rows, np.float64).reshape(len(rows), 3)


@dataclass(frozen=True)
class State:
    total_force: Vector
    points: tuple[Vector, ...]


@dataclass(frozen=True)
class Message:
    foot: int
    log_time: int
    stamp: int
    states: tuple[State, ...]


def contacts_of(messages: list[Message]) -> Contacts:
    """Columns of messages: all their first states, then all second ones, as the reader does."""
    most = max((len(message.states) for message in messages), default=0)
    states = [
        (row, message.states[index])
        for index in range(most)
        for row, message in enumerate(messages)
        if index < len(message.states)
    ]
    points = [(row, point) for row, (_, state) in enumerate(states) for point in state.points]
    return Contacts(
        foot=np.array([message.foot for message in messages], np.int64),
        log_time=np.array([message.log_time for message in messages], np.int64),
        stamp=np.array([message.stamp for message in messages], np.int64),
        state_message=np.array([row for row, _ in states], np.int64),
        foot_side=np.full(len(states), FOOT_IS_COLLISION1, np.int8),
        newest=np.arange(len(states)) % 2 == 0,  # classic does not look
        total_force=vectors([state.total_force for _, state in states]),
        point_state=np.array([row for row, _ in points], np.int64),
        point=vectors([point for _, point in points]),
        wrench_state=np.empty(0, np.int64),
        wrench_force=vectors([]),
        normal_state=np.empty(0, np.int64),
        normal=vectors([]),
    )


def pressed(force: Vector) -> Message:
    return Message(0, 5, 7, (State(force, ((1.0, 2.0, 3.0),)),))


components: Final = st.one_of(
    st.floats(-250, 250),
    st.floats(-30, 30),
    st.floats(),
    st.sampled_from([0.0, -0.0, NAN, INF, -INF, 1e154, 1.4e154, -1e200, 5e-324, 200.0]),
)
points: Final = st.tuples(*[st.floats(-9, 9) | st.sampled_from([NAN, INF])] * 3)


def turned_x(quaternion: object) -> list[float]:
    """Rotate (1, 0, 0) by a unit quaternion x, y, z, w: the first column of its matrix."""
    x, y, z, w = np.asarray(quaternion).tolist()
    return [w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)]


BOUNDS_NM: Final = (380, 440, 490, 510, 580, 645, 750)
BLACK: Final = [0.0, 0.0, 0.0, 1.0]


@dataclass(frozen=True)
class Marker:
    """What the script published, with float32 colours."""

    position: Vector
    orientation: tuple[float, float, float, float]
    length: float
    colour: tuple[float, float, float, float]


class ScriptRaised(Exception):  # noqa: N818 - it is no error here
    pass


def square(component: float) -> float:
    squared = component * component
    if math.isinf(squared) and not math.isinf(component):
        raise ScriptRaised  # OverflowError
    return squared


def script_marker(message: Message) -> Marker | None:
    if len(message.states) == 0:
        return None
    state = message.states[0]
    if len(state.points) == 0:
        raise ScriptRaised  # IndexError
    fx, fy, fz = state.total_force
    p = math.sqrt(square(fx) + square(fy) + square(fz)) / 100
    wavelength = 380 + ((p - 0.0) / (2.0 - 0.0)) * (750 - 380)
    red, green, blue = light(wavelength)
    return Marker(
        position=state.points[0],
        orientation=(0, math.sin(-0.785), 0, math.cos(-0.785)),
        length=p,
        colour=(float32(red), float32(green), float32(blue), 1.0),
    )


def float32(value: float) -> float:
    return float(np.float32(value))


def bits(numbers: object) -> bytes:
    return np.asarray(numbers, np.float64).tobytes()


def assert_as_the_script(messages: list[Message]) -> None:
    expected: list[tuple[Message, Marker]] = []
    raised = 0
    for message in messages:
        try:
            marker = script_marker(message)
        except ScriptRaised:
            raised += 1
            continue
        if marker is not None:
            expected.append((message, marker))

    arrows, counts = classic_arrows(contacts_of(messages))

    assert counts["no_position"] + counts["overflow"] == raised
    assert (counts["not_finite"], counts["no_direction"]) == (0, 0)
    assert arrows.foot.tolist() == [message.foot for message, _ in expected]
    assert arrows.log_time.tolist() == [message.log_time for message, _ in expected]
    assert arrows.stamp.tolist() == [message.stamp or message.log_time for message, _ in expected]
    assert arrows.visible.all()
    markers = [marker for _, marker in expected]
    assert bits(arrows.position) == bits([marker.position for marker in markers])
    assert bits(arrows.orientation) == bits([marker.orientation for marker in markers])
    assert bits(arrows.length) == bits([marker.length for marker in markers])
    assert arrows.colour.dtype == np.float32
    assert bits(arrows.colour) == bits([marker.colour for marker in markers])


def neighbours(value: float, count: int) -> list[float]:
    """The value, and so many floats on each side of it."""
    found = [value]
    for towards in (-INF, INF):
        neighbour = value
        for _ in range(count):
            neighbour = math.nextafter(neighbour, towards)
            found.append(neighbour)
    return found


def test_classic_at_every_bound_of_the_colours_and_beside_it() -> None:
    messages = []
    for bound in BOUNDS_NM:
        force = 100 * 2 * (bound - 380) / (750 - 380)
        for near in neighbours(force, 40):
            messages.extend([pressed((0, 0, near)), pressed((near, 0, 0))])
            messages.append(pressed((near * 0.36, near * 0.48, near * 0.8)))
    assert_as_the_script(messages)


LARGEST: Final = math.sqrt(1.7976931348623157e308)


@pytest.mark.parametrize(
    ("why", "messages"),
    [
        (
            "overflow",
            [
                pressed(force)
                for force in [(1e155, 0, 0), (NAN, INF, 1.7e308), (LARGEST * 1.001, 1, 1)]
            ],
        ),
        (
            "no_position",
            [
                Message(1, 10, 0, (State((0, 0, 5), ()),)),
                Message(2, 20, 0, (State((0, 0, 5), ()), State((0, 0, 9), ((1, 2, 3),)))),
            ],
        ),
    ],
)
def test_classic_skips_and_counts_what_the_script_raised_at(
    why: str, messages: list[Message]
) -> None:
    assert_as_the_script(messages)

    arrows, counts = classic_arrows(contacts_of(messages))
    assert counts == Counter({why: len(messages)})
    assert len(arrows.foot) == 0


def test_classic_draws_the_first_state_whatever_step_or_body_it_is_of() -> None:
    first, second = State((0, 0, 30), ((1, 1, 1), (5, 5, 5))), State((0, 0, 70), ((2, 2, 2),))
    messages = [Message(0, 1, 1, (first, second, second)), Message(1, 2, 2, (second, first))]
    contacts = contacts_of(messages)
    sides = np.full(len(contacts.newest), 2, np.int8)
    arrows, _ = classic_arrows(replace(contacts, newest=~contacts.newest, foot_side=sides))
    assert arrows.length.tolist() == [0.3, 0.7]
    assert arrows.position.tolist() == [[1, 1, 1], [2, 2, 2]]


def test_colours_beside_a_rounding_boundary_of_float32_are_exact() -> None:
    """Of wavelengths whose colour lies as near as can be halfway between two float32 numbers."""
    stored = np.random.default_rng(4).uniform(0.05, 1, 5000).astype(np.float32)
    halfway = (stored.astype(np.float64) + np.nextafter(stored, np.float32(2))) / 2
    wavelengths = 510 + (580 - 510) * halfway**1.25
    around = np.concatenate([wavelengths, np.nextafter(wavelengths, 0)])

    expected = np.array([(*light(each), 1.0) for each in around.tolist()], np.float32)
    assert wavelength_to_rgba(around).tobytes() == expected.tobytes()


states: Final = st.builds(
    State, st.tuples(components, components, components), st.lists(points, max_size=3).map(tuple)
)
messages_strategy: Final = st.lists(
    st.builds(
        Message,
        st.integers(0, 3),
        st.integers(1, 2**62),
        st.just(0) | st.integers(1, 2**62),
        st.lists(states, max_size=4).map(tuple),
    ),
    max_size=12,
)


@settings(generated, max_examples=30)
@given(messages_strategy)
def test_classic_equals_the_script_to_the_bit(messages: list[Message]) -> None:
    assert_as_the_script(messages)


@pytest.mark.parametrize("count", [5_000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_classic_equals_the_script_for_thousands_of_loads(count: int) -> None:
    random = np.random.default_rng(20)
    magnitude = random.uniform(0, 205, count)
    direction = random.normal(size=(count, 3))
    force = magnitude[:, None] * direction / np.linalg.norm(direction, axis=1)[:, None]
    assert_as_the_script([pressed((x, y, z)) for x, y, z in force.tolist()])


def unit(vector: Vector) -> Vector:
    length = math.hypot(*vector)
    return (vector[0] / length, vector[1] / length, vector[2] / length)


nearly_zero: Final = st.floats(1e-100, 1e-6) | st.floats(-1e-6, -1e-100)
unit_vectors: Final = st.one_of(
    st.tuples(*[st.floats(-1, 1).map(lambda x: round(x, 12))] * 3)
    .filter(lambda v: math.hypot(*v) > 0.01)
    .map(unit),
    # The two ends of the x axis, and beside them; a test below goes nearer still.
    st.tuples(
        st.sampled_from([1.0, -1.0]),
        *[st.just(0.0) | nearly_zero | st.sampled_from([1e-9, -1e-20, 1e-100])] * 2,
    ).map(unit),
    st.sampled_from([(0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]),
)


@settings(generated, max_examples=150)
@given(unit_vectors)
def test_the_rotation_is_the_shortest_that_turns_x_to_the_direction(direction: Vector) -> None:
    (quaternion,) = turn_x_to(vectors([direction]))

    assert math.hypot(*quaternion.tolist()) == pytest.approx(1, abs=1e-15)
    assert turned_x(quaternion) == pytest.approx(list(direction), abs=2e-15)
    # Its axis is at right angles to both, so it does not roll; its angle is the angle between.
    assert quaternion[0] == 0
    assert 2 * math.acos(min(1, abs(quaternion[3]))) == pytest.approx(
        math.atan2(math.hypot(direction[1], direction[2]), direction[0]), abs=1e-7
    )


@pytest.mark.parametrize("beside", [1e-20, 1e-100, 1e-160, 1e-170, 1e-300, 5e-324])
@pytest.mark.parametrize("end", [1.0, -1.0])
def test_the_rotation_is_right_however_near_the_axis(end: float, beside: float) -> None:
    quaternions = turn_x_to(vectors([(end, beside, 0), (end, 0, -beside), (end, beside, beside)]))

    for quaternion in quaternions:
        assert turned_x(quaternion) == pytest.approx([end, 0, 0], abs=1e-15)
