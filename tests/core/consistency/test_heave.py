"""How late the base follows the feet's forces, in walks whose heave these forces drive."""

from dataclasses import replace

import pytest

from tests.truth import gaits, world_faults
from tests.truth.core_columns import measure
from tests.truth.recording import Disturbance, Recording, disturbed
from tests.truth.walking import Walk

UNEVEN = Walk(
    gait=gaits.Gait("walk", (0.0, 0.5, 0.72, 0.22), 0.75, "lateral"),
    period_s=1.0,
    seconds=15.0,
    shares=(0.29, 0.27, 0.23, 0.21),
)


def delay_s(*disturbances: Disturbance, walk: Walk = UNEVEN) -> float | None:
    found = measure(disturbed(walk.recorded(200.0, 100.0), *disturbances)).base_delay
    return None if found is None else found.delay_s


def flatter(recording: Recording) -> Recording:
    """Let the base go half as far up and down."""
    position = recording.base.position * [1.0, 1.0, 0.5]
    return replace(recording, base=replace(recording.base, position=position))


@pytest.mark.parametrize("late", [-0.3, -0.1, 0.1, 0.2, 0.3])
def test_a_late_odometry_is_told(late: float) -> None:
    found = delay_s(world_faults.driven, world_faults.restamped(late))
    assert found == pytest.approx(late, abs=0.015)


@pytest.mark.parametrize("late", [0.0, 0.03])
def test_odometry_in_time_is_not_late(late: float) -> None:
    assert delay_s(world_faults.driven, world_faults.restamped(late)) is None


def test_nothing_is_told_of_a_base_that_does_not_follow_the_forces() -> None:
    late = world_faults.restamped(0.2)
    assert delay_s(late) is None
    assert delay_s(world_faults.driven, flatter, late) is None
    assert delay_s(world_faults.driven, world_faults.pose_noise(0.03), late) is None


def test_nothing_is_told_where_the_heave_repeats_itself_too_soon() -> None:
    """A trot heaves twice a stride: late by 0.1 s is early by 0.3 s."""
    assert delay_s(world_faults.driven, world_faults.restamped(0.1), walk=Walk()) is None


def test_short_logs_tell_nothing() -> None:
    late = world_faults.driven, world_faults.restamped(0.2)
    assert delay_s(*late, walk=replace(UNEVEN, seconds=4.0)) is None
