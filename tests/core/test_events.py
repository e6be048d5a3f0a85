"""Planted events are found where they were planted, and none where none was."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.events.event import text_of, with_steps
from dogbot_logtool.core.events.events import find_events
from dogbot_logtool.core.metrics import Event
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.core.walk import Walk as MeasuredWalk
from dogbot_logtool.writer import described
from tests.analysed import analysed
from tests.truth import gaits, planted, scenes, time_faults, world_faults
from tests.truth import sensor_faults as sensor
from tests.truth.core_columns import measure, stats_settings
from tests.truth.recording import Disturbance, Recording, disturbed, on
from tests.truth.robots import biped
from tests.truth.scenes import Scene
from tests.truth.sequences import then
from tests.truth.walking import Walk

RATE_HZ = 250.0
SAMPLE_S = 1.0 / RATE_HZ
WITHIN_S = 0.02
FRONT_RIGHT = 1
S = 1_000_000_000


def walk(*changes: Disturbance, **of: object) -> Recording:
    return disturbed(Walk(seconds=12.0, **of).recorded(RATE_HZ), *changes)  # type: ignore[arg-type]


def odd_events(
    recording: Recording, stats: MeasuredWalk | None = None
) -> list[tuple[float, Event]]:
    """All events but touchdowns and lift-offs, with their onsets in seconds."""
    return [(each.onset_s, each) for each in find_events(stats or measure(recording))]


def swing_of(foot: int, number: int, **of: object) -> tuple[float, float]:
    """Begin and end of a swing."""
    truth = Walk(seconds=12.0, **of)  # type: ignore[arg-type]
    liftoff = truth.liftoffs(foot)[number]
    touchdowns = truth.touchdowns(foot)
    return float(liftoff), float(touchdowns[touchdowns > liftoff][0])


CLEAN: dict[str, Callable[[], Recording]] = {
    "trot": walk,
    "walk": lambda: walk(gait=gaits.WALK, period_s=1.1),
    "gallop": lambda: walk(gait=gaits.ROTARY_GALLOP, period_s=0.5, speed_mps=2.0),
    "biped": lambda: walk(gait=gaits.BIPED_WALK, robot=biped(80.0), period_s=1.2),
    "slope": lambda: walk(slope_rad=0.3),
    "noisy poses": lambda: walk(world_faults.pose_noise(0.002)),
    "slip": lambda: walk(slip_m=0.004),
    "rolling": lambda: walk(planted.rolling(0.06)),
}


@pytest.mark.parametrize("name", CLEAN)
def test_clean_walks_have_no_odd_events(name: str) -> None:
    assert odd_events(CLEAN[name]()) == []


@pytest.mark.parametrize(
    "scene",
    [
        scenes.standing(),
        scenes.shifting_weight(),
        scenes.crouching(),
        scenes.sitting_down(),
        scenes.standing_up(),
        scenes.rolling(),
    ],
)
def test_scenes_without_an_event_have_none(scene: Scene) -> None:
    assert odd_events(scene.recorded(RATE_HZ)) == []


@pytest.mark.parametrize("rolling_m", [None, 0.0, 0.01])
@pytest.mark.parametrize("metres", [0.01, 0.05])
def test_a_slip_is_found_within_20_ms(metres: float, rolling_m: float | None) -> None:
    _, lands = swing_of(FRONT_RIGHT, 6)
    at = lands + 0.25
    recording = walk(planted.slip("front_right", at, metres))
    stats = measure(recording, stats_settings(recording, foot_rolling_m=rolling_m))
    [(onset, slip)] = odd_events(recording, stats)
    assert slip.type == "slip"
    assert slip.foot == "front_right"
    assert onset == pytest.approx(at, abs=WITHIN_S)
    assert slip.duration_s == pytest.approx(0.04, abs=WITHIN_S)
    assert slip.value == pytest.approx(metres, abs=1e-6)


@pytest.mark.parametrize("share", [0.3, 0.5, 0.6])
def test_a_stumble_is_found_within_20_ms(share: float) -> None:
    leaves, lands = swing_of(FRONT_RIGHT, 6)
    at = leaves + share * (lands - leaves)
    [(onset, stumble)] = odd_events(walk(planted.contact("front_right", at, at + 0.05)))
    assert stumble.type == "stumble"
    assert stumble.foot == "front_right"
    assert onset == pytest.approx(at, abs=WITHIN_S)
    assert stumble.duration_s == pytest.approx(0.05, abs=WITHIN_S)
    assert stumble.value == pytest.approx(share, abs=0.05)


def test_a_foot_that_lands_early_and_stays_is_an_early_contact() -> None:
    leaves, lands = swing_of(FRONT_RIGHT, 6)
    at = leaves + 0.5 * (lands - leaves)
    [(onset, early)] = odd_events(walk(planted.contact("front_right", at)))
    assert early.type == "early_contact"
    assert onset == pytest.approx(at, abs=WITHIN_S)
    assert early.value == pytest.approx(lands - at, abs=WITHIN_S)


@pytest.mark.parametrize("end", [0.0, 1.0])
def test_a_bounce_at_either_end_of_a_swing_is_no_event(end: float) -> None:
    leaves, lands = swing_of(FRONT_RIGHT, 6)
    at = leaves + 0.03 if end == 0.0 else lands - 0.06
    assert odd_events(walk(planted.contact("front_right", at, at + 0.03))) == []


def test_a_fall_is_found_within_300_ms() -> None:
    recording = then(walk(), scenes.falling().recorded(RATE_HZ))
    [(onset, fall)] = [each for each in odd_events(recording) if each[1].type == "fall"]
    assert onset == pytest.approx(recording.truth.falls_s[0], abs=0.3)
    assert fall.code == "FALL"


def test_being_carried_is_found_with_its_height() -> None:
    recording = scenes.carried().recorded(RATE_HZ)
    [(onset, event)] = odd_events(recording)
    start, end = recording.truth.carried_s[0]
    assert event.type == "carried"
    assert onset == pytest.approx(start, abs=0.03)
    assert event.duration_s == pytest.approx(end - start, abs=0.06)
    assert event.value == pytest.approx(0.55, abs=0.05)


TROT = Walk(seconds=12.0)
SLOW = Walk(gait=gaits.WALK, seconds=9.0, period_s=1.0)


@pytest.mark.parametrize(
    ("first", "second", "code"),
    [
        (TROT, SLOW, "trot>walk"),
        (TROT, Walk(seconds=9.0, period_s=0.5), "trot>trot"),
        (TROT, scenes.standing(), "trot>stand"),
        (scenes.standing(), TROT, "stand>trot"),
    ],
)
def test_a_change_of_the_gait_is_found_within_a_stride(
    first: Walk | Scene, second: Walk | Scene, code: str
) -> None:
    recording = then(first.recorded(RATE_HZ), second.recorded(RATE_HZ))
    events = odd_events(recording)
    # Where recordings are joined, feet that are down are suddenly elsewhere.
    [(onset, change)] = [each for each in events if each[1].type != "slip"]
    assert change.type == "gait_change"
    assert change.code == code
    assert onset == pytest.approx(first.seconds, abs=0.8)


def test_a_gait_that_lasts_between_two_alike_is_two_changes() -> None:
    recording = TROT.recorded(RATE_HZ)
    for part in (SLOW, TROT):
        recording = then(recording, part.recorded(RATE_HZ))
    changes = [(at, each) for at, each in odd_events(recording) if each.type == "gait_change"]
    assert [each.code for _, each in changes] == ["trot>walk", "walk>trot"]
    begins = [TROT.seconds, TROT.seconds + SLOW.seconds]
    assert [at for at, _ in changes] == pytest.approx(begins, abs=1.0)


def test_a_jump_of_the_pose_is_found() -> None:
    [(onset, jump)] = odd_events(walk(world_faults.jump(4.0, (1.0, 0.5, 0.0))))
    assert jump.type == "pose_jump"
    assert onset == pytest.approx(4.0, abs=WITHIN_S)
    assert jump.value == pytest.approx(float(np.hypot(1.0, 0.5)), abs=0.01)


def test_a_gap_of_one_foot_is_found() -> None:
    [(onset, gap)] = odd_events(walk(on(time_faults.silent_between(3.0, 5.0), "back_left")))
    assert gap.type == "gap"
    assert gap.foot == "back_left"
    assert onset == pytest.approx(3.0, abs=2.0 * SAMPLE_S)
    assert gap.value == pytest.approx(2.0, abs=3.0 * SAMPLE_S)


def test_tipping_is_found_where_the_recording_ends() -> None:
    events = odd_events(scenes.tipping().recorded(RATE_HZ))
    [(onset, tipping)] = [each for each in events if each[1].type == "tipping"]
    assert onset == pytest.approx(7.0, abs=0.3)
    assert abs(tipping.value or 0.0) == pytest.approx(0.35, abs=0.01)


@pytest.mark.parametrize(
    ("fault", "code"),
    [
        (on(sensor.stuck(60.0), "front_right"), "STUCK"),
        (sensor.saturated(80.0), "SATURATED"),
        (sensor.spikes(2000.0, 3.0), "SPIKES"),
    ],
)
def test_a_sensor_at_fault_is_found(fault: Disturbance, code: str) -> None:
    if code == "STUCK":
        fault = both(fault, always_touching)
    recording = walk(fault, traction=0.0)
    events = odd_events(recording)
    found = [each for _, each in events if each.type == "sensor_fault"]
    assert {each.code for each in found} == {code}


def both(first: Disturbance, second: Disturbance) -> Disturbance:
    return lambda recording: second(first(recording))


def always_touching(recording: Recording) -> Recording:
    return recording.each_foot(
        lambda _, foot: replace(foot, touching=np.ones_like(foot.touching)), "front_right"
    )


def test_a_base_outside_its_polygon_is_found_with_the_least_margin() -> None:
    forward = scenes.through((3.0, 0.0), (3.5, 0.4), (4.5, 0.4), (5.0, 0.0))
    events = odd_events(Scene(scenes.STILL, forward=forward).recorded(RATE_HZ))
    [(onset, margin)] = [e for e in events if e[1].type == "margin_below_zero"]
    assert 3.0 < onset < 3.5
    assert margin.value == pytest.approx(-0.1, abs=0.005)
    assert 1.0 < margin.duration_s < 2.0


def test_a_log_without_feet_has_neither_events_nor_gaits() -> None:
    stats = analysed(WalkSettings(feet=()))
    assert (stats.segments, with_steps(stats.metrics)) == ((), ())


def test_a_log_panel_shows_each_fact_once() -> None:
    """The panel writes the source before the text."""
    slip = Event(1.0, 0.02, "slip", "right", 0.012, "m", None)
    gap = Event(1.0, 1.01, "gap", "left", 1.01, "s", None)
    assert [text_of(each) for each in (slip, gap)] == [
        "slip, 0.012 m, for 0.020 s",
        "gap, 1.01 s",
    ]
    ends = described.span(4 * S, slip).literal["end_time"]
    assert ends == {"sec": 4, "nanosec": 20_000_000}
