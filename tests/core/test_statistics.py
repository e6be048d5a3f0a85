"""Whole walks in closed form, measured: gaits, and the conventions that fool naive tools."""

from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.statistics import Stats
from tests.analysed import feet_of
from tests.core.checks.voided import metrics
from tests.oracles.straight_walk import (
    FEET,
    RATE_HZ,
    SETTINGS,
    WALK,
    WEIGHT_N,
    Walk,
    codes,
    foot_samples,
    main_class,
    measure,
)


def test_a_trot_is_measured_right() -> None:
    walk = Walk()
    stats = walk.measure()
    assert main_class(stats) == "trot"
    for row, foot in enumerate(feet_of(stats)):
        true = [each for each in walk.touchdowns(row) if each > 0.01]
        found = [each for each in foot.touchdown_s or () if each > 0.01]
        assert found == pytest.approx(true, abs=1.0 / RATE_HZ)
        assert foot.stride_frequency_hz == pytest.approx(1.25, rel=2e-3)
        assert foot.duty_factor is not None
        assert foot.duty_factor.mean == pytest.approx(0.6, abs=0.003)
        assert foot.stride_length_m is not None
        assert foot.stride_length_m.mean == pytest.approx(0.4, abs=0.002)
        assert foot.peak_force_n is not None
        assert foot.peak_force_n.mean == pytest.approx(WEIGHT_N / 4 / 0.6 * np.pi / 2, rel=1e-3)
        assert foot.slip_m is not None
        assert foot.slip_m.max == 0.0
    assert stats.loads.vertical_impulse_over_weight == pytest.approx(1.0, abs=0.01)
    assert stats.loads.shares == pytest.approx([0.25] * 4, abs=0.002)
    assert stats.support is not None
    # Each pair is down for 0.6 of the stride: both are for 0.2 of it.
    assert stats.support.feet_down == pytest.approx([0, 0, 0.8, 0, 0.2], abs=0.01)
    assert codes(stats) <= {"SAMPLED_SLOWLY"}


def test_a_trot_with_a_duty_factor_above_one_half_is_a_trot_that_does_not_run() -> None:
    stats = Walk(duty=(0.714,) * 4, period_s=1.142).measure()
    assert main_class(stats) == "trot"
    assert stats.main is not None
    assert stats.main.duty_factor == pytest.approx(0.714, abs=0.003)


def test_a_running_trot_has_flight() -> None:
    stats = Walk(duty=(0.4,) * 4).measure()
    assert main_class(stats) == "trot"
    assert stats.support is not None
    assert stats.support.flight_fraction == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize(
    ("axis", "speed_mps", "said"),
    [("+x", 0.5, ""), ("+y", 0.5, "right"), ("-y", 0.5, "left"), ("+y", 0.03, "")],
)
def test_a_robot_that_seems_to_walk_sideways_is_told(
    axis: str, speed_mps: float, said: str
) -> None:
    stats = Walk(speed_mps=speed_mps).measure(replace(SETTINGS, forward_axis=axis))
    found = [remark.text for remark in findings_of(stats) if remark.code == "FORWARD_AXIS"]
    assert len(found) == bool(said)
    assert all(f"to the {said} of its forward axis {axis}, at 0.50 m/s" in text for text in found)


def test_a_walk_in_lateral_sequence() -> None:
    stats = Walk(phases=WALK, duty=(0.8,) * 4, period_s=1.0).measure()
    assert stats.main is not None
    assert (stats.main.gait.name, stats.main.gait.sequence) == ("walk", "lateral")
    assert stats.stability is not None
    assert stats.stability.undefined_fraction == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("phase", [0.99, 0.01])
def test_phases_that_straddle_zero_do_not_spoil_the_class(phase: float) -> None:
    stats = Walk(phases=(0.0, 0.5, 0.49, phase)).measure()
    assert main_class(stats) == "trot"
    assert stats.main is not None
    last = stats.main.phases[3]
    assert last is not None
    assert abs((last.mean - phase + 0.5) % 1.0 - 0.5) < 0.005
    assert last.consistency > 0.99


def test_touchdowns_that_jitter_around_the_references_are_one_phase() -> None:
    """The back right foot lands now 12 ms before the front left one, now 12 ms after it."""
    walk = Walk()
    feet = [walk.samples(foot) for foot in range(4)]
    time = walk.times()
    late = np.where(np.floor((time - 0.6) / 0.8) % 2 == 0, 0.012, -0.012)
    feet[3] = foot_samples(3, time, walk.force(3, time + late), walk.points(3, time))
    stats = measure(feet, walk.odometry())
    assert main_class(stats) == "trot"
    assert len(stats.segments) == 1


def test_a_limp_is_a_trot_with_asymmetry() -> None:
    stats = Walk(duty=(0.6, 0.6, 0.6, 0.5), load=(1.1, 1.0, 1.1, 0.8)).measure()
    assert main_class(stats) == "trot"
    assert len(stats.segments) == 1
    shares = stats.loads.shares
    assert shares is not None
    assert shares[3] == pytest.approx(0.2, abs=0.005)
    left, right = (foot.stance_s for foot in feet_of(stats)[2:])
    assert left is not None
    assert right is not None
    assert right.mean / left.mean == pytest.approx(5 / 6, abs=0.02)


def test_a_gait_change_cuts_the_time_line() -> None:
    walk = Walk(phases=WALK, duty=(0.8,) * 4, period_s=1.0, seconds=10.0)
    trot = Walk(seconds=14.0)
    first, second = walk.times()[:-1], trot.times()
    time = np.concatenate([first, 10.0 + second])
    feet = [
        foot_samples(
            foot,
            time,
            np.concatenate([walk.force(foot, first), trot.force(foot, second)]),
            np.zeros((len(time), 3)),
        )
        for foot in range(4)
    ]
    stats = measure(feet, Walk(seconds=24.0).odometry())
    assert [segment.gait.name for segment in stats.segments] == ["walk", "trot"]
    change = (stats.segments[0].end - stats.origin) / 1e9
    assert change == pytest.approx(10.0, abs=1.0)
    assert stats.segments[0].stride_frequency_hz == pytest.approx(1.0, rel=0.02)
    assert stats.segments[1].stride_frequency_hz == pytest.approx(1.25, rel=0.02)
    assert main_class(stats) == "trot"
    assert "SEVERAL_GAITS" in codes(stats)


def test_a_change_of_pace_cuts_the_time_line_too() -> None:
    slow, fast = Walk(period_s=1.2, seconds=12.0), Walk(period_s=0.6, seconds=9.0)
    first, second = slow.times()[:-1], fast.times()
    time = np.concatenate([first, 12.0 + second])
    feet = [
        foot_samples(
            foot,
            time,
            np.concatenate([slow.force(foot, first), fast.force(foot, second)]),
            np.zeros((len(time), 3)),
        )
        for foot in range(4)
    ]
    stats = measure(feet, Walk(seconds=21.0).odometry())
    assert [segment.gait.name for segment in stats.segments] == ["trot", "trot"]


def test_a_robot_that_stands() -> None:
    walk = Walk(begins_s=100.0, speed_mps=0.0)
    stats = walk.measure()
    assert main_class(stats) == "stand"
    assert stats.loads.vertical_impulse_over_weight == pytest.approx(1.0)
    assert [foot.contact_fraction for foot in feet_of(stats)] == [1.0] * 4
    assert [foot.stride_frequency_hz for foot in feet_of(stats)] == [None] * 4
    assert [foot.peak_force_n for foot in feet_of(stats)] == [None] * 4
    assert stats.stability is not None
    assert stats.stability.static_margin_m is not None
    assert stats.stability.static_margin_m.mean == pytest.approx(0.15)


def test_a_stand_before_a_walk_is_a_segment_of_its_own() -> None:
    stats = Walk(begins_s=4.0).measure()
    assert [segment.gait.name for segment in stats.segments] == ["stand", "trot"]
    assert (stats.segments[0].end - stats.origin) / 1e9 == pytest.approx(4.0, abs=0.6)
    assert main_class(stats) == "trot"


def test_what_a_fallen_robots_feet_do_is_not_walking() -> None:
    walk = Walk()
    odometry = walk.odometry()
    fallen = walk.times() >= 8.0
    odometry.orientation[fallen] = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
    stats = measure([walk.samples(foot) for foot in range(4)], odometry)
    assert "FALL" in codes(stats)
    assert (stats.fallen[0, 0] - stats.origin) / 1e9 == pytest.approx(8.0, abs=0.02)
    for foot in stats.feet:
        assert (foot.strides.end <= stats.fallen[0, 0]).all()
        assert foot.discarded["fall"] >= 4


def test_a_collapse_without_a_lean_is_a_fall_too_but_climbing_is_not() -> None:
    walk = Walk()
    feet = [walk.samples(foot) for foot in range(4)]
    down = walk.odometry()
    down.position[:, 2] = np.interp(walk.times(), [8.0, 8.3], [0.45, 0.1])
    assert "FALL" in codes(measure(feet, down))
    up = walk.odometry()
    up.position[:, 2] += walk.times()
    for samples in feet:
        samples.position[:, 2] += walk.times()
    assert "FALL" not in codes(measure(feet, up))


def test_link_frame_wrenches_have_magnitudes_only() -> None:
    walk = Walk()
    stats = walk.measure(replace(SETTINGS, wrench_frame=WrenchFrame.LINK))
    world = walk.measure()
    for foot, truth in zip(feet_of(stats), feet_of(world), strict=True):
        assert foot.peak_force_n == truth.peak_force_n
        assert foot.peak_vertical_force_n is None
        assert foot.vertical_impulse_ns is None
        assert foot.friction_use is None
    assert stats.loads.vertical_impulse_over_weight is None
    assert stats.loads.share_of == "force_impulse"
    assert stats.stability is not None
    assert stats.stability.centre_of_pressure_forward_m is None


def test_two_feet_have_phases_but_no_class() -> None:
    walk = Walk()
    settings = replace(SETTINGS, feet=FEET[:2])
    stats = measure([walk.samples(0), walk.samples(1)], walk.odometry(), settings)
    assert stats.main is not None
    phase = stats.main.phases[1]
    assert phase is not None
    assert phase.mean == pytest.approx(0.5, abs=0.005)
    assert stats.main.gait.name is None


def test_wheels_and_wrong_contacts_are_no_stand_and_no_gait() -> None:
    walk = Walk()
    time = walk.times()
    loaded = np.full(len(time), WEIGHT_N / 4.0)
    feet = [foot_samples(foot, time, loaded, walk.points(foot, 0.0 * time)) for foot in range(4)]
    stats = measure(feet, walk.odometry())
    assert [segment.gait.name for segment in stats.segments] == [None]
    assert stats.segments[0].moves_without_steps
    assert "MOVES_WITHOUT_STEPS" in codes(stats)


def test_a_crawl_whose_stances_last_half_a_minute_is_a_walk() -> None:
    stats = Walk(WALK, (0.8,) * 4, period_s=40.0, seconds=130.0, speed_mps=0.01).measure()
    assert main_class(stats) == "walk"
    foot = feet_of(stats)[0]
    assert foot.stance_s is not None
    assert foot.stance_s.mean == pytest.approx(32.0, abs=0.05)
    assert foot.duty_factor is not None
    assert foot.duty_factor.mean == pytest.approx(0.8, abs=0.001)
    assert stats.base is not None
    assert stats.base.path_length_m == pytest.approx(1.3, abs=0.02)


def test_a_stance_that_holds_a_stand_is_no_part_of_a_stride() -> None:
    stats = Walk(begins_s=4.0).measure()
    for foot in feet_of(stats):
        assert foot.stance_s is not None
        assert foot.stance_s.max == pytest.approx(0.48, abs=0.01)


def test_the_feet_correct_a_guessed_forward_axis_but_not_a_given_one() -> None:
    guessed = replace(SETTINGS, forward_axis="+y", forward_axis_is_assumed=True)
    stats = Walk().measure(guessed)
    assert stats.settings.forward_axis == "+x"
    assert stats.base is not None
    assert stats.base.forward_speed_mps == pytest.approx(0.5, rel=1e-3)
    assert stats.settings.forward_axis_reason
    given = Walk().measure(replace(guessed, forward_axis_is_assumed=False))
    assert given.settings.forward_axis == "+y"
    assert not given.settings.forward_axis_reason


def test_without_contact_points_the_motion_corrects_it_unless_the_robot_walks_backward() -> None:
    def walked(axis: str) -> Stats:
        walk = Walk()
        feet = [walk.samples(foot) for foot in range(4)]
        for samples in feet:
            samples.position[:] = np.nan
        settings = replace(SETTINGS, forward_axis=axis, forward_axis_is_assumed=True)
        return measure(feet, walk.odometry(), settings)

    assert walked("+y").settings.forward_axis == "+x"
    assert walked("-x").settings.forward_axis == "-x"


def test_heights_are_over_the_feet_and_unknown_in_another_world() -> None:
    def walked(moved: tuple[float, float, float]) -> Stats:
        walk = Walk()
        odometry = walk.odometry()
        odometry.position[:] += moved
        feet = [walk.samples(foot) for foot in range(4)]
        for samples in feet:
            samples.position[:, 2] += 3.0
        return measure(feet, odometry)

    same = walked((0.0, 0.0, 3.0))
    assert same.base is not None
    assert same.base.height_m is not None
    assert same.base.height_m.mean == pytest.approx(0.45)
    assert same.base.froude == pytest.approx(0.25 / (9.81 * 0.45), rel=0.01)
    assert same.base.slope_rad == pytest.approx(0.0, abs=1e-6)
    for moved in ((0.0, 0.0, -0.45), (8.0, 0.0, 3.0)):
        other = walked(moved)
        assert other.base is not None
        assert (other.base.height_m, other.base.froude) == (None, None)


def test_every_segment_has_its_own_base_and_steps() -> None:
    stats = Walk(begins_s=4.0).measure()
    stand, trot = metrics(stats).gait.segments
    assert stand.base.path_length_m == 0.0
    assert trot.base.forward_speed_mps == pytest.approx(0.5, rel=0.01)
    assert stand.feet["front_left"].stance_s is None
    assert trot.feet["front_left"].duty_factor is not None
    assert trot.feet["front_left"].duty_factor.mean == pytest.approx(0.6, abs=0.005)
    assert trot.feet["front_left"].strides == stats.segments[1].strides
