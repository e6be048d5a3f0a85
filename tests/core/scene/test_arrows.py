"""Arrows in the three styles.

`classic` is compared, to the bit, with a plain-Python transcription of the live script's
formulas, message by message; the other styles with what a person would draw.
"""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.contact.contacts import FOOT_IS_COLLISION1, Contacts, Samples
from dogbot_logtool.core.scene.arrows import (
    ArrowCounts,
    Arrows,
    ArrowScale,
    arrow_scale,
    classic_arrows,
    force_arrows,
    pressure_arrows,
    turn_x_to,
)
from tests.oracles.conversion import light

Vector = tuple[float, float, float]

INF: Final = math.inf
NAN: Final = math.nan
BODY_WEIGHT_N: Final = 208.5
BOUNDS_NM: Final = (380, 440, 490, 510, 580, 645, 750)
BLACK: Final = [0.0, 0.0, 0.0, 1.0]

generated = settings(max_examples=75, deadline=None)


# --- the live script, message by message ------------------------------------------------------


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


# --- samples for it ---------------------------------------------------------------------------


def vectors(rows: list[Vector]) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.array(rows, np.float64).reshape(len(rows), 3)


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

    assert counts.no_position + counts.overflow == raised
    assert (counts.not_finite, counts.no_direction) == (0, 0)
    assert arrows.foot.tolist() == [message.foot for message, _ in expected]
    assert arrows.log_time.tolist() == [message.log_time for message, _ in expected]
    assert arrows.stamp.tolist() == [message.stamp or message.log_time for message, _ in expected]
    assert arrows.shown.all()
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


def test_classic_samples_meet_every_bound_exactly() -> None:
    # So that the test above is about the bounds themselves: a force for each wavelength.
    for bound in BOUNDS_NM:
        forces = neighbours(100 * 2 * (bound - 380) / (750 - 380), 40)
        wavelengths = [380 + (force / 100 - 0.0) / (2.0 - 0.0) * (750 - 380) for force in forces]
        assert bound in wavelengths


def test_classic_is_black_just_past_full_scale() -> None:
    full, past = 200.0, 200.0000000000002  # nearer ones round to 750 nm
    arrows, _ = classic_arrows(contacts_of([pressed((0, 0, full)), pressed((0, 0, past))]))

    assert arrows.length[1] > 2.0
    assert arrows.colour[0, 0] > 0
    assert arrows.colour[1].tolist() == BLACK


def test_classic_writes_what_is_not_finite_as_it_is() -> None:
    forces = [(NAN, 0, 0), (0, INF, 0), (0, 0, -INF), (INF, -INF, NAN), (-0.0, 0, 0)]
    assert_as_the_script([pressed(force) for force in forces])

    arrows, counts = classic_arrows(contacts_of([pressed(force) for force in forces[:4]]))
    assert counts == ArrowCounts()
    assert arrows.colour.tolist() == [BLACK] * 4


def test_classic_copies_a_position_that_is_not_finite() -> None:
    assert_as_the_script([Message(0, 1, 1, (State((0, 0, 50), ((NAN, INF, -INF),)),))])


def test_classic_skips_and_counts_a_square_that_overflows() -> None:
    largest = math.sqrt(1.7976931348623157e308)
    forces = [(1e155, 0, 0), (0, -1e200, 0), (NAN, INF, 1.7e308), (largest * 1.001, 1, 1)]
    messages = [pressed(force) for force in forces]
    assert_as_the_script(messages)

    arrows, counts = classic_arrows(contacts_of(messages))
    assert counts == ArrowCounts(overflow=4)
    assert len(arrows.foot) == 0


def test_classic_writes_a_sum_that_overflows_in_black() -> None:
    message = pressed((1.3e154, 1.3e154, 0))
    assert_as_the_script([message])

    arrows, counts = classic_arrows(contacts_of([message]))
    assert counts == ArrowCounts()
    assert arrows.length.tolist() == [INF]
    assert arrows.colour.tolist() == [BLACK]


def test_classic_skips_and_counts_a_first_state_without_points() -> None:
    other = State((0, 0, 9), ((1, 2, 3),))
    messages = [
        Message(1, 10, 0, (State((0, 0, 5), ()),)),
        Message(2, 20, 0, (State((0, 0, 5), ()), other)),
    ]
    assert_as_the_script(messages)

    arrows, counts = classic_arrows(contacts_of(messages))
    assert counts == ArrowCounts(no_position=2)
    assert len(arrows.foot) == 0


def test_classic_writes_nothing_without_contact() -> None:
    arrows, counts = classic_arrows(contacts_of([Message(0, 1, 1, ()), Message(1, 2, 2, ())]))

    assert counts == ArrowCounts()
    assert len(arrows.foot) == 0
    assert arrows.position.shape == (0, 3)
    assert arrows.colour.shape == (0, 4)


def test_classic_of_no_messages_is_nothing() -> None:
    arrows, counts = classic_arrows(contacts_of([]))

    assert counts == ArrowCounts()
    assert len(arrows.foot) == 0


def test_classic_draws_the_first_state_whatever_step_or_body_it_is_of() -> None:
    first, second = State((0, 0, 30), ((1, 1, 1), (5, 5, 5))), State((0, 0, 70), ((2, 2, 2),))
    messages = [Message(0, 1, 1, (first, second, second)), Message(1, 2, 2, (second, first))]
    contacts = contacts_of(messages)

    for newest in (True, False):
        for side in (0, 1, 2):
            states = len(contacts.newest)
            varied = replace(
                contacts,
                newest=np.full(states, newest),
                foot_side=np.full(states, side, np.int8),
            )
            arrows, _ = classic_arrows(varied)
            assert arrows.length.tolist() == [0.3, 0.7]
            assert arrows.position.tolist() == [[1, 1, 1], [2, 2, 2]]


components: Final = st.one_of(
    st.floats(-250, 250),
    st.floats(-30, 30),
    st.floats(),
    st.sampled_from([0.0, -0.0, NAN, INF, -INF, 1e154, 1.4e154, -1e200, 5e-324, 200.0]),
)
points: Final = st.tuples(*[st.floats(-9, 9) | st.sampled_from([NAN, INF])] * 3)
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


# --- pressure ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class DrawnSample:
    """One sample, in contact with a load of 50 N unless told otherwise."""

    force: Vector = (0, 0, 50)
    in_contact: bool = True
    in_world: bool = False
    points: int = 1
    position: Vector = (1, 2, 0)
    normal: Vector = (0, 0, 1)
    stamp: int = 0


LIFTED: Final = DrawnSample((0, 0, 0), False, False, 0, (NAN, NAN, NAN), (NAN, NAN, NAN))  # noqa: FBT003


def samples_of(*felt: DrawnSample) -> Samples:
    count = len(felt)
    return Samples(
        foot=np.arange(count) % 4,
        log_time=np.arange(count) * 10 + 1000,
        stamp=np.array([one.stamp for one in felt], np.int64),
        in_contact=np.array([one.in_contact for one in felt], np.bool_),
        force=vectors([one.force for one in felt]),
        in_world=np.array([one.in_world for one in felt], np.bool_),
        points=np.array([one.points for one in felt], np.int64),
        position=vectors([one.position for one in felt]),
        normal=vectors([one.normal for one in felt]),
    )


def turned_x(quaternion: object) -> list[float]:
    """Rotate (1, 0, 0) by a unit quaternion x, y, z, w: the first column of its matrix."""
    x, y, z, w = np.asarray(quaternion).tolist()
    return [w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)]


def test_pressure_stands_on_the_contact_point_and_is_as_long_as_the_load() -> None:
    felt = [
        DrawnSample((3, 4, 12)),
        DrawnSample((0, 0, -70), position=(5, 6, 7)),
        DrawnSample((120, 0, 0)),
    ]

    arrows, counts = pressure_arrows(samples_of(*felt))

    assert counts == ArrowCounts()
    assert arrows.shown.all()
    assert arrows.length.tolist() == [0.13, 0.7, 1.2]
    assert arrows.position.tolist() == [[1, 2, 0], [5, 6, 7], [1, 2, 0]]


def test_pressure_points_straight_up_whatever_the_force() -> None:
    arrows, _ = pressure_arrows(
        samples_of(DrawnSample((0, 0, 50)), DrawnSample((50, -20, 0)), DrawnSample((0, 0, -9)))
    )

    for quaternion in arrows.orientation:
        assert turned_x(quaternion) == pytest.approx([0, 0, 1], abs=1e-15)


def test_newtons_per_metre_scale_the_length_but_not_the_colour() -> None:
    samples = samples_of(DrawnSample((0, 0, 50)))

    usual, _ = pressure_arrows(samples)
    longer, _ = pressure_arrows(samples, ArrowScale(25.0))

    assert usual.length.tolist() == [0.5]
    assert longer.length.tolist() == [2.0]
    assert longer.colour.tolist() == usual.colour.tolist()


def test_pressure_has_the_colours_of_classic_up_to_full_scale() -> None:
    loads = [DrawnSample((0, 0, load)) for load in np.linspace(1, 200, 300).tolist()]

    arrows, _ = pressure_arrows(samples_of(*loads))
    classic, _ = classic_arrows(contacts_of([pressed(felt.force) for felt in loads]))

    assert arrows.colour == pytest.approx(classic.colour, abs=1e-6)


@pytest.mark.parametrize("load", [200.00000000000003, 201.0, 5000.0, 1e150])
def test_pressure_stays_red_past_full_scale(load: float) -> None:
    full, _ = pressure_arrows(samples_of(DrawnSample((0, 0, 200))))
    past, _ = pressure_arrows(samples_of(DrawnSample((0, 0, load))))

    assert past.colour.tolist() == full.colour.tolist()
    assert past.colour[0].tolist() == pytest.approx([0.3**0.8, 0, 0, 1])
    assert past.shown.all()


@pytest.mark.parametrize("style", ["pressure", "force"])
def test_lift_off_removes_the_arrow_and_is_no_fault(style: str) -> None:
    arrows, counts = drawn(style, DrawnSample(), LIFTED, DrawnSample(), LIFTED)

    assert arrows.shown.tolist() == [True, False, True, False]
    assert arrows.foot.tolist() == [0, 1, 2, 3]
    assert arrows.log_time.tolist() == [1000, 1010, 1020, 1030]
    assert counts == ArrowCounts()


@pytest.mark.parametrize("style", ["pressure", "force"])
@pytest.mark.parametrize("zero", [(0, 0, 0), (-0.0, 0, -0.0), (1e-200, 0, 0)])
def test_contact_without_load_removes_the_arrow_and_is_no_fault(style: str, zero: Vector) -> None:
    arrows, counts = drawn(style, DrawnSample(zero))

    assert arrows.shown.tolist() == [False]
    assert counts == ArrowCounts()


@pytest.mark.parametrize("style", ["pressure", "force"])
@pytest.mark.parametrize("force", [(NAN, 0, 1), (0, INF, 0), (0, 0, -INF), (1e200, 1, 1)])
def test_a_load_that_is_not_finite_removes_the_arrow_and_is_counted(
    style: str, force: Vector
) -> None:
    arrows, counts = drawn(style, DrawnSample(), DrawnSample(force))

    assert arrows.shown.tolist() == [True, False]
    assert counts == ArrowCounts(not_finite=1)


@pytest.mark.parametrize("style", ["pressure", "force"])
@pytest.mark.parametrize("position", [(NAN, 0, 0), (0, INF, 0), (0, 0, -INF)])
def test_a_position_that_is_not_finite_removes_the_arrow_and_is_counted(
    style: str, position: Vector
) -> None:
    arrows, counts = drawn(style, DrawnSample(position=position))

    assert arrows.shown.tolist() == [False]
    assert counts == ArrowCounts(not_finite=1)


@pytest.mark.parametrize("style", ["pressure", "force"])
def test_contact_without_a_point_removes_the_arrow_and_is_counted(style: str) -> None:
    nowhere = DrawnSample(points=0, position=(NAN, NAN, NAN))

    arrows, counts = drawn(style, nowhere, DrawnSample())

    assert arrows.shown.tolist() == [False, True]
    assert counts == ArrowCounts(no_position=1)


@pytest.mark.parametrize("style", ["pressure", "force"])
def test_numbers_that_are_not_finite_are_no_fault_without_contact(style: str) -> None:
    arrows, counts = drawn(style, replace(LIFTED, force=(NAN, INF, 0)))

    assert arrows.shown.tolist() == [False]
    assert counts == ArrowCounts()


@pytest.mark.parametrize("style", ["pressure", "force"])
def test_the_stamp_is_the_messages_or_its_log_time_where_that_is_zero(style: str) -> None:
    arrows, _ = drawn(style, DrawnSample(stamp=77), DrawnSample(stamp=0))

    assert arrows.stamp.tolist() == [77, 1010]


@pytest.mark.parametrize("style", ["pressure", "force"])
def test_no_samples_give_no_arrows(style: str) -> None:
    arrows, counts = drawn(style)

    assert len(arrows.shown) == 0
    assert arrows.orientation.shape == (0, 4)
    assert counts == ArrowCounts()


def drawn(style: str, *felt: DrawnSample) -> tuple[Arrows, ArrowCounts]:
    samples = samples_of(*felt)
    if style == "pressure":
        return pressure_arrows(samples)
    return force_arrows(samples, force_in_world=True, body_weight_n=BODY_WEIGHT_N)


felt_strategy: Final = st.builds(
    DrawnSample,
    force=st.tuples(components, components, components),
    in_contact=st.booleans(),
    in_world=st.booleans(),
    points=st.integers(0, 3),
    position=points,
    normal=st.sampled_from([(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (-1.0, 0.0, 0.0), (NAN, NAN, NAN)]),
)


@generated
@given(st.lists(felt_strategy, max_size=8), st.booleans())
def test_what_is_shown_can_be_drawn_and_what_is_not_is_explained(
    felt: list[DrawnSample],
    force_in_world: bool,  # noqa: FBT001
) -> None:
    samples = samples_of(*felt)
    for arrows, counts in (
        pressure_arrows(samples),
        force_arrows(samples, force_in_world=force_in_world, body_weight_n=None),
    ):
        shown = arrows.shown
        assert np.isfinite(arrows.position[shown]).all()
        assert np.isfinite(arrows.length[shown]).all()
        assert (arrows.length[shown] > 0).all()
        assert np.isfinite(arrows.orientation[shown]).all()
        assert np.linalg.norm(arrows.orientation[shown], axis=1) == pytest.approx(1, abs=1e-12)
        assert ((arrows.colour[shown] >= 0) & (arrows.colour[shown] <= 1)).all()
        unloaded = sum(
            one.in_contact and math.hypot(*one.force) < 1e-150 and one.points > 0 for one in felt
        )
        explained = counts.not_finite + counts.no_position + counts.no_direction
        in_contact = sum(one.in_contact for one in felt)
        assert in_contact - unloaded <= shown.sum() + explained <= in_contact


# --- force ------------------------------------------------------------------------------------


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
def test_the_rotation_turns_x_to_the_direction(direction: Vector) -> None:
    (quaternion,) = turn_x_to(vectors([direction]))

    assert math.hypot(*quaternion.tolist()) == pytest.approx(1, abs=1e-15)
    assert turned_x(quaternion) == pytest.approx(list(direction), abs=2e-15)


@settings(generated, max_examples=100)
@given(unit_vectors)
def test_the_rotation_is_the_shortest(direction: Vector) -> None:
    (quaternion,) = turn_x_to(vectors([direction]))

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


@generated
@given(unit_vectors, st.floats(1, 200))
def test_a_world_frame_force_is_drawn_along_itself(direction: Vector, load: float) -> None:
    x, y, z = direction
    felt = DrawnSample((x * load, y * load, z * load), normal=(0, 0, 1))

    arrows, counts = force_arrows(samples_of(felt), force_in_world=True, body_weight_n=None)

    assert counts == ArrowCounts()
    assert arrows.length.tolist() == pytest.approx([load / 100])
    assert turned_x(arrows.orientation[0]) == pytest.approx(list(direction), abs=1e-14)


def test_where_only_the_magnitude_is_known_it_is_drawn_along_the_normal() -> None:
    felt = DrawnSample((30, 40, 0), normal=(0.6, 0, 0.8))

    arrows, counts = force_arrows(samples_of(felt), force_in_world=False, body_weight_n=None)

    assert counts == ArrowCounts()
    assert arrows.length.tolist() == [0.5]
    assert turned_x(arrows.orientation[0]) == pytest.approx([0.6, 0, 0.8], abs=1e-15)


def test_a_force_read_off_the_ground_is_drawn_along_itself_even_beside_link_frame_ones() -> None:
    link, world = DrawnSample((30, 40, 0)), DrawnSample((30, 40, 0), in_world=True)

    arrows, _ = force_arrows(samples_of(link, world), force_in_world=False, body_weight_n=None)

    assert turned_x(arrows.orientation[0]) == pytest.approx([0, 0, 1], abs=1e-15)
    assert turned_x(arrows.orientation[1]) == pytest.approx([0.6, 0.8, 0], abs=1e-15)


def test_without_a_normal_a_link_frame_force_has_no_direction_and_is_counted() -> None:
    blind = DrawnSample(normal=(NAN, NAN, NAN))

    arrows, counts = force_arrows(
        samples_of(blind, DrawnSample(), replace(blind, in_world=True)),
        force_in_world=False,
        body_weight_n=None,
    )

    assert arrows.shown.tolist() == [False, True, True]
    assert counts == ArrowCounts(no_direction=1)


def test_force_is_coloured_by_body_weights() -> None:
    shares = np.linspace(0.01, 1.5, 40).tolist()
    loads = [DrawnSample((0, 0, share * BODY_WEIGHT_N)) for share in shares]

    arrows, _ = drawn("force", *loads)

    for share, colour in zip(shares, arrows.colour.tolist(), strict=True):
        wavelength = 380 + share / 1.5 * (750 - 380)
        assert colour == pytest.approx([*light(min(wavelength, 750)), 1], abs=1e-6)


def test_force_stays_red_past_one_and_a_half_body_weights() -> None:
    arrows, _ = drawn("force", DrawnSample((0, 0, 1.6 * BODY_WEIGHT_N)), DrawnSample((0, 0, 1e9)))

    assert arrows.colour.tolist() == [pytest.approx([0.3**0.8, 0, 0, 1])] * 2


def test_force_has_the_colours_of_pressure_where_the_weight_is_not_known() -> None:
    loads = samples_of(*[DrawnSample((0, 0, load)) for load in np.linspace(1, 300, 50).tolist()])

    force, _ = force_arrows(loads, force_in_world=True, body_weight_n=None)
    pressure, _ = pressure_arrows(loads)

    assert force.colour == pytest.approx(pressure.colour, abs=1e-6)


def test_a_weight_is_as_long_as_the_base_is_high_unless_the_robot_s_file_says_else() -> None:
    assert arrow_scale(100.0, 785.0, 0.9) == ArrowScale(100.0, 200.0)
    assert arrow_scale(None, 785.0, 0.5) == ArrowScale(1570.0, 1177.5)
    assert arrow_scale(None, None, 0.5) == ArrowScale(100.0, 200.0)
    load = samples_of(DrawnSample((0.0, 0.0, 785.0)))
    arrows, _ = pressure_arrows(load, arrow_scale(None, 785.0, 0.9))
    assert arrows.length.tolist() == pytest.approx([0.9])


def test_force_lengths_follow_newtons_per_metre() -> None:
    arrows, _ = force_arrows(
        samples_of(DrawnSample((0, 0, 50))),
        force_in_world=True,
        body_weight_n=BODY_WEIGHT_N,
        scale=ArrowScale(500.0),
    )

    assert arrows.length.tolist() == [0.1]


def test_counts_add_up() -> None:
    assert ArrowCounts(1, 2, 3, 4) + ArrowCounts(10, 20, 30, 40) == ArrowCounts(11, 22, 33, 44)
