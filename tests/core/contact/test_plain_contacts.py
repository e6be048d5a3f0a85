"""Samples of contact messages agree with a plain reading of them, message by message."""

import math
from dataclasses import dataclass
from typing import Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.contact.contacts import (
    FOOT_IS_COLLISION1,
    FOOT_IS_COLLISION2,
    NOT_THIS_FOOT,
    contact_samples,
)
from tests.core.contact.states import Message, State, Vector, contacts_of

NAN: Final = math.nan
SIDES: Final = (FOOT_IS_COLLISION1, FOOT_IS_COLLISION2, NOT_THIS_FOOT)


@dataclass(frozen=True)
class Plain:
    in_contact: bool
    in_world: bool
    force: list[float]
    points: int
    position: list[float]
    normal: list[float]


def magnitude(vector: Vector) -> float:
    return math.sqrt(sum(component * component for component in vector))


def plain_sample(message: Message) -> Plain:
    used = [state for state in message if state.newest and state.side != NOT_THIS_FOOT]
    force, normal = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
    weighted: list[tuple[float, Vector]] = []
    for state in used:
        sign = -1 if state.side == FOOT_IS_COLLISION2 else 1
        force = [sum_ + sign * one for sum_, one in zip(force, state.force, strict=True)]
        for vector in state.normals:
            normal = [sum_ + sign * one for sum_, one in zip(normal, vector, strict=True)]
        weights = [magnitude(wrench) for wrench in state.wrenches]
        if len(weights) != len(state.points):
            weights = [magnitude(state.force) / len(state.points) for _ in state.points]
        weighted += zip(weights, state.points, strict=True)
    if sum(weight for weight, _ in weighted) == 0:
        weighted = [(1.0, point) for _, point in weighted]
    total = sum(weight for weight, _ in weighted)
    length = magnitude((normal[0], normal[1], normal[2]))
    return Plain(
        in_contact=bool(used),
        in_world=bool(used) and all(state.side == FOOT_IS_COLLISION2 for state in used),
        force=force,
        points=len(weighted),
        position=[
            sum(weight * point[axis] for weight, point in weighted) / total if weighted else NAN
            for axis in range(3)
        ],
        normal=[component / length if length else NAN for component in normal],
    )


forces: Final = st.tuples(
    *[st.floats(-300, 300).map(lambda x: round(x, 3)) | st.sampled_from([0.0, NAN, math.inf])] * 3
)
places: Final = st.tuples(*[st.floats(-5, 5).map(lambda x: round(x, 4))] * 3)
zero_forces: Final = st.just((0.0, 0.0, 0.0))
unit_normals: Final = st.sampled_from(
    [(0.0, 0.0, 1.0), (0.0, 0.6, 0.8), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 0.0)]
)


@st.composite
def states(draw: st.DrawFn) -> State:
    points = draw(st.lists(places, max_size=3))
    paired = draw(st.booleans())
    fewest, most = (len(points), len(points)) if paired else (0, 4)
    wrench = draw(st.sampled_from([forces, zero_forces]))
    wrenches = draw(st.lists(wrench, min_size=fewest, max_size=most))
    return State(
        force=draw(forces | zero_forces),
        points=tuple(points),
        wrenches=tuple(wrenches),
        normals=tuple(draw(st.lists(unit_normals, max_size=3))),
        side=draw(st.sampled_from(SIDES)),
        newest=draw(st.booleans()),
    )


@settings(max_examples=100, deadline=None)
@given(data=st.data(), messages=st.lists(st.lists(states(), max_size=3).map(tuple), max_size=5))
def test_samples_equal_a_plain_reading_however_states_of_messages_mix(
    data: st.DataObject, messages: list[Message]
) -> None:
    by_message = [row for row, message in enumerate(messages) for _ in message]
    order = data.draw(st.permutations(by_message))

    samples = contact_samples(contacts_of(messages, order))

    assert len(samples.foot) == len(messages)
    for row, message in enumerate(messages):
        expected = plain_sample(message)
        assert samples.in_contact[row] == expected.in_contact
        assert samples.in_world[row] == expected.in_world
        assert samples.points[row] == expected.points
        assert samples.force[row].tolist() == approximately(expected.force)
        assert samples.position[row].tolist() == approximately(expected.position)
        assert samples.normal[row].tolist() == approximately(expected.normal)


def approximately(numbers: list[float]) -> object:
    return pytest.approx(numbers, rel=1e-9, abs=1e-9, nan_ok=True)
