"""The wrench frame is told from how near the forces lie to the contact normals."""

import math
from typing import Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.wrench_frame import (
    FEWEST_SAMPLES,
    WrenchFrame,
    alignment,
    judge_wrench_frame,
)
from dogbot_logtool.core.geometry.arrays import Floats

Vector = tuple[float, float, float]

NAN: Final = math.nan
UP: Final = (0.0, 0.0, 1.0)


def samples_of(
    forces: Floats,
    normals: Floats | None = None,
    *,
    in_world: bool = False,
    in_contact: bool = True,
) -> Samples:
    count = len(forces)
    return Samples(
        foot=np.zeros(count, np.int64),
        log_time=np.arange(count),
        stamp=np.arange(count),
        in_contact=np.full(count, in_contact),
        force=forces,
        in_world=np.full(count, in_world),
        points=np.ones(count, np.int64),
        position=np.zeros((count, 3)),
        normal=np.tile(np.array(UP), (count, 1)) if normals is None else normals,
    )


def one(force: Vector, normal: Vector = UP, **kinds: bool) -> Samples:
    return samples_of(np.array([force], np.float64), np.array([normal]), **kinds)


def pitched(vectors: Floats, angles: Floats) -> Floats:
    """Vectors of the world as a link sees them that is turned about y by each angle."""
    x, y, z = vectors.T
    cosine, sine = np.cos(angles), np.sin(angles)
    return np.stack([cosine * x - sine * z, y, sine * x + cosine * z], axis=1)


def trot(friction: float, seed: int = 1) -> Floats:
    """World-frame forces of 10 to 150 N that lean no more than friction allows."""
    random = np.random.default_rng(seed)
    vertical = random.uniform(10, 150, 400)
    lean, heading = random.uniform(0, friction, 400), random.uniform(0, 2 * np.pi, 400)
    side = vertical * lean
    return np.stack([side * np.cos(heading), side * np.sin(heading), vertical], axis=1)


# --- alignment --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("force", "normal", "along"),
    [
        ((0, 0, 50), UP, 1),
        ((0, 0, -50), UP, 1),
        ((50, 0, 0), UP, 0),
        ((30, 0, 40), UP, 0.8),
        ((30, 0, 40), (0.6, 0, 0.8), 1),
        ((-30, 0, 40), (0.6, 0, 0.8), (32 - 18) / 50),
    ],
)
def test_alignment_is_the_cosine_between_force_and_normal(
    force: Vector, normal: Vector, along: float
) -> None:
    assert alignment(one(force, normal)).tolist() == [pytest.approx(along, abs=1e-15)]


@pytest.mark.parametrize("force", [(0, 0, 9.99), (0, 0, 0), (NAN, 0, 50), (0, 0, math.inf)])
def test_light_and_infinite_forces_say_nothing(force: Vector) -> None:
    assert len(alignment(one(force))) == 0


def test_ten_newtons_say_something() -> None:
    assert len(alignment(one((0, 0, 10)))) == 1


def test_samples_without_a_normal_say_nothing() -> None:
    assert len(alignment(one((0, 0, 50), (NAN, NAN, NAN)))) == 0


def test_samples_read_off_the_ground_say_nothing() -> None:
    assert len(alignment(one((0, 0, 50), in_world=True))) == 0


def test_samples_without_contact_say_nothing() -> None:
    assert len(alignment(one((0, 0, 50), in_contact=False))) == 0


@settings(max_examples=100, deadline=None)
@given(st.lists(st.tuples(*[st.floats(-500, 500)] * 3), max_size=20))
def test_alignments_lie_between_zero_and_one(forces: list[Vector]) -> None:
    samples = samples_of(np.array(forces, np.float64).reshape(-1, 3))

    along = alignment(samples)

    assert len(along) == sum(math.hypot(*force) >= 10 for force in forces)
    assert ((along >= 0) & (along <= 1 + 1e-12)).all()


# --- judgement --------------------------------------------------------------------------------


def test_world_frame_forces_within_friction_are_told() -> None:
    evidence = judge_wrench_frame(alignment(samples_of(trot(friction=0.5))))

    assert evidence.frame is WrenchFrame.WORLD
    assert evidence.samples == 400
    assert evidence.median_alignment is not None
    assert evidence.median_alignment > 0.95


def test_forces_in_the_frame_of_a_swinging_lower_leg_are_told() -> None:
    angles = np.random.default_rng(2).uniform(0.4, 1.2, 400)

    evidence = judge_wrench_frame(alignment(samples_of(pitched(trot(friction=0.3), angles))))

    assert evidence.frame is WrenchFrame.LINK
    assert evidence.median_alignment is not None
    assert evidence.median_alignment < 0.95


def test_forces_in_the_frames_of_a_sloping_ground_are_world_frame() -> None:
    angles = np.full(400, 0.5)
    normals = pitched(np.tile(np.array(UP), (400, 1)), angles)

    evidence = judge_wrench_frame(alignment(samples_of(pitched(trot(0.3), angles), normals)))

    assert evidence.frame is WrenchFrame.WORLD


def test_a_few_outliers_do_not_matter() -> None:
    along = np.concatenate([np.zeros(40), np.ones(60)])

    assert judge_wrench_frame(along).frame is WrenchFrame.WORLD
    assert judge_wrench_frame(1 - along).frame is WrenchFrame.LINK


@pytest.mark.parametrize(
    ("median", "frame"),
    [(0.95, WrenchFrame.WORLD), (math.nextafter(0.95, 0), WrenchFrame.LINK)],
)
def test_the_bound_belongs_to_the_world(median: float, frame: WrenchFrame) -> None:
    evidence = judge_wrench_frame(np.full(21, median))

    assert (evidence.frame, evidence.median_alignment) == (frame, median)


def test_few_samples_decide_nothing_but_are_told() -> None:
    few = judge_wrench_frame(np.ones(FEWEST_SAMPLES - 1))

    assert (few.frame, few.median_alignment, few.samples) == (WrenchFrame.UNKNOWN, 1.0, 19)
    assert judge_wrench_frame(np.ones(FEWEST_SAMPLES)).frame is WrenchFrame.WORLD


def test_no_samples_decide_nothing() -> None:
    evidence = judge_wrench_frame(np.empty(0))

    assert (evidence.frame, evidence.median_alignment, evidence.samples) == (
        WrenchFrame.UNKNOWN,
        None,
        0,
    )


def test_frames_have_the_names_of_the_option() -> None:
    assert [str(frame) for frame in WrenchFrame] == ["world", "link", "unknown"]
