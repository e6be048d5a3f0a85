"""The wrench frame is told from physics, against forces whose frame is known."""

import math
from dataclasses import replace
from typing import Final

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.wrench_frame import (
    FEWEST_SAMPLES,
    FrameFit,
    WrenchFrame,
    frame_fit,
    judge_wrench_frame,
)

UP: Final = np.array([0.0, 0.0, 1.0])
FEET: Final = 4
MEAN_N: Final = 50.0
"""Mean vertical force of each foot; the robot weighs four times as much."""
STRIDES: Final = 10
DUTY: Final = 0.5
PHASE: Final = np.tile(np.arange(100) / 100.0, STRIDES)
"""(n,) stride phase of each of a foot's samples."""


def about_y(vectors: Floats, angles: Floats | float) -> Floats:
    """Vectors as a frame has them that is pitched by each angle."""
    x, y, z = vectors.T
    cosine, sine = np.cos(angles), np.sin(angles)
    return np.stack([cosine * x - sine * z, y + 0.0 * x, sine * x + cosine * z], axis=1)


def walk(fore_aft: float = 0.0) -> Floats:
    """World forces of one foot: half a sine upwards in stance, first braking, then propelling.

    Args:
        fore_aft: amplitude of the fore-aft force, as a share of the vertical amplitude.
    """
    stance = PHASE / DUTY
    top = MEAN_N / DUTY * np.pi / 2.0
    vertical = top * np.sin(np.pi * stance)
    along = -fore_aft * top * np.sin(2.0 * np.pi * stance)
    forces = np.stack([along, 0.0 * along, vertical], axis=1)
    return np.where((stance < 1.0)[:, None], forces, 0.0)


def samples_of(forces: Floats, normal: Floats = UP, foot: int = 0) -> Samples:
    count = len(forces)
    touching = (forces != 0.0).any(axis=1)
    return Samples(
        foot=np.full(count, foot),
        log_time=np.arange(count),
        stamp=np.arange(count),
        in_contact=touching,
        force=forces,
        in_world=np.zeros(count, np.bool_),
        points=touching.astype(np.int64),
        position=np.zeros((count, 3)),
        normal=np.where(touching[:, None], normal, np.nan),
    )


def robot(forces: Floats, *pitches: float, normal: Floats = UP) -> list[Samples]:
    """Four feet with the same forces, as links have them that are pitched."""
    pitches = pitches or (0.0,) * FEET
    return [samples_of(about_y(forces, pitch), normal, foot) for foot, pitch in enumerate(pitches)]


def frame(samples: list[Samples]) -> WrenchFrame:
    return judge_wrench_frame(frame_fit(samples)).frame


def fit(samples: list[Samples]) -> FrameFit:
    found = frame_fit(samples)
    assert found is not None
    return found


# --- fit --------------------------------------------------------------------------------------


def test_the_vertical_sum_is_the_weight_in_the_right_frame_only() -> None:
    assert fit(robot(walk())).vertical_n == pytest.approx(FEET * MEAN_N, rel=0.001)
    leaning = fit(robot(walk(), *(0.6,) * FEET))
    assert leaning.vertical_n == pytest.approx(FEET * MEAN_N * math.cos(0.6), rel=0.001)


def test_tilts_are_those_of_the_summed_force() -> None:
    leaning = fit(robot(walk(), *(0.4,) * FEET))
    assert leaning.net_tilt == pytest.approx(math.tan(0.4), rel=1e-6)
    mirrored = fit(robot(walk(), 0.4, 0.4, -0.4, -0.4))
    assert mirrored.net_tilt == pytest.approx(0.0, abs=1e-6)
    assert mirrored.foot_tilt == pytest.approx(math.tan(0.4), rel=1e-6)


def test_the_friction_cone_stands_on_the_normal() -> None:
    steep = np.array([math.sin(1.0), 0.0, math.cos(1.0)])
    assert fit(robot(walk())).in_cone == 1.0
    assert fit(robot(walk(), normal=steep)).in_cone == 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_normals_may_point_either_way(sign: float) -> None:
    assert fit(robot(walk(), normal=sign * UP)).in_cone == 1.0


@pytest.mark.parametrize("scale", [0.005, 1.0, 500.0])
def test_heavy_and_light_robots_are_judged_alike(scale: float) -> None:
    one, scaled = fit(robot(walk(0.3))), fit(robot(scale * walk(0.3)))
    assert scaled.samples == one.samples
    assert scaled.in_cone == pytest.approx(one.in_cone)
    assert scaled.net_tilt == pytest.approx(one.net_tilt, abs=1e-9)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_samples_that_are_not_finite_are_left_out(bad: float) -> None:
    parts = robot(walk())
    parts[0].force[10] = bad
    assert fit(parts).in_cone == 1.0


def test_forces_read_off_the_ground_count_in_the_sum_only() -> None:
    parts = [*robot(walk(), 0.8, 0.8, 0.8)[:3], samples_of(walk(), foot=3)]
    parts[3].in_world[:] = True
    leaning = fit(parts)
    assert leaning.net_tilt == pytest.approx(math.tan(0.8), rel=1e-6)
    assert leaning.vertical_n == pytest.approx((3 * math.cos(0.8) + 1) * MEAN_N, rel=0.001)
    assert frame_fit(parts[3:]) is None


def test_without_normals_nothing_is_told() -> None:
    assert frame_fit(robot(walk(), normal=np.full(3, np.nan))) is None
    assert frame(robot(walk(), normal=np.full(3, np.nan))) is WrenchFrame.UNKNOWN


def test_too_few_samples_tell_nothing() -> None:
    few = samples_of(np.tile([0.0, 0.0, 50.0], (FEWEST_SAMPLES - 1, 1)))
    enough = samples_of(np.tile([0.0, 0.0, 50.0], (FEWEST_SAMPLES, 1)))
    assert frame_fit([few]) is None
    assert fit([enough]).samples == FEWEST_SAMPLES
    assert frame_fit([]) is None


# --- judgement without transforms -------------------------------------------------------------


@pytest.mark.parametrize("degrees", [0, 5, 10, 15, 20, 25])
@pytest.mark.parametrize("fore_aft", [0.0, 0.2])
def test_a_slope_is_no_link_frame(degrees: float, fore_aft: float) -> None:
    """The weight stays vertical, the normals lean."""
    lean = math.radians(degrees)
    normal = np.array([-math.sin(lean), 0.0, math.cos(lean)])
    assert frame(robot(walk(fore_aft), normal=normal)) is WrenchFrame.WORLD


@pytest.mark.parametrize("fore_aft", [0.3, 0.4, 0.5])
def test_a_gallop_is_no_link_frame(fore_aft: float) -> None:
    assert frame(robot(walk(fore_aft))) is WrenchFrame.WORLD


def test_feet_of_a_bound_that_only_brake_or_only_propel_are_in_the_world() -> None:
    brakes, propels = walk(), walk()
    brakes[:, 0], propels[:, 0] = -0.3 * brakes[:, 2], 0.3 * propels[:, 2]
    bound = [samples_of(force, foot=foot) for foot, force in enumerate([brakes, propels] * 2)]
    assert frame(bound) is WrenchFrame.WORLD


@pytest.mark.parametrize("pitch", [0.4, 0.8, 1.3, -0.8, 2.0])
def test_links_that_lean_alike_are_told(pitch: float) -> None:
    assert frame(robot(walk(0.2), *(pitch,) * FEET)) is WrenchFrame.LINK


def test_mirrored_links_are_not_told_from_feet_that_push_apart() -> None:
    assert frame(robot(walk(), 0.5, 0.5, -0.5, -0.5)) is WrenchFrame.UNKNOWN


def test_mirrored_links_beyond_any_friction_are_told() -> None:
    assert frame(robot(walk(), 1.0, 1.0, -1.0, -1.0)) is WrenchFrame.LINK


# --- judgement with transforms ----------------------------------------------------------------


def turned(samples: list[Samples], pitch: Floats | float) -> FrameFit | None:
    """Fit of forces that transforms turn back from pitched links."""
    parts = [
        replace(part, force=about_y(part.force, -pitch), in_world=np.ones_like(part.in_world))
        for part in samples
    ]
    return frame_fit(parts, [part.in_contact for part in parts])


def both(samples: list[Samples], pitch: Floats | float, weight_n: float | None = None) -> str:
    """Judge recorded forces where transforms say that every link is pitched."""
    recorded = frame_fit(samples)
    return judge_wrench_frame(recorded, turned(samples, pitch), weight_n).frame


@pytest.mark.parametrize("pitch", [0.3, 0.7, 1.2])
@pytest.mark.parametrize("fore_aft", [0.0, 0.5])
def test_both_hypotheses_are_tried(pitch: float, fore_aft: float) -> None:
    assert both(robot(walk(fore_aft)), pitch) is WrenchFrame.WORLD
    assert both(robot(walk(fore_aft), *(pitch,) * FEET), pitch) is WrenchFrame.LINK


def test_of_two_possible_frames_the_more_vertical_one_is_taken() -> None:
    assert both(robot(walk()), 0.15) is WrenchFrame.WORLD
    assert both(robot(walk(), *(0.15,) * FEET), 0.15) is WrenchFrame.LINK


SWING: Final = 0.6 * np.cos(np.pi * PHASE / DUTY)
"""rad, pitch of legs that swing from one side of the vertical to the other."""


def test_the_weight_decides_between_two_possible_frames() -> None:
    """Legs push along themselves: as links have it, straight; in the world, along the swing."""
    weight_n = FEET * MEAN_N
    straight = robot(walk())
    leaning = turned(straight, SWING)
    assert leaning is not None
    assert leaning.in_world
    assert both(straight, SWING, weight_n) is WrenchFrame.WORLD
    assert both(straight, SWING, leaning.vertical_n) is WrenchFrame.LINK
    assert both(straight, SWING) is WrenchFrame.UNKNOWN


def test_upright_links_make_no_difference() -> None:
    assert both(robot(walk(), *(0.01,) * FEET), 0.01) is WrenchFrame.WORLD


def test_where_neither_frame_fits_none_is_claimed() -> None:
    assert both(robot(walk(), *(1.2,) * FEET), 0.3) is WrenchFrame.UNKNOWN


def test_frames_have_the_names_of_the_option() -> None:
    assert [str(frame) for frame in WrenchFrame] == ["world", "link", "unknown"]
