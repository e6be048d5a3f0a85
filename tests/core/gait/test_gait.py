import numpy as np
import pytest

from dogbot_logtool.core.gait.gait import (
    class_distances,
    classify,
    diagonality,
    phases_by_stride,
    phases_in,
)
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.leg_position import quadruped

SURE = (1.0, 1.0, 1.0, 1.0)
S = 1_000_000_000


@pytest.mark.parametrize(
    ("phases", "name", "sequence"),
    [
        ((0.0, 0.0, 0.0, 0.0), "pronk", None),
        ((0.0, 0.5, 0.5, 0.0), "trot", None),
        ((0.0, 0.55, 0.48, 0.95), "trot", None),
        ((0.0, 0.5, 0.0, 0.5), "pace", None),
        ((0.0, 0.0, 0.4, 0.4), "bound", None),
        ((0.0, 0.5, 0.75, 0.25), "walk", "lateral"),
        ((0.0, 0.5, 0.25, 0.75), "walk", "diagonal"),
        ((0.0, 0.5, 0.83, 0.33), "walk", "lateral"),
        ((0.0, 0.25, 0.5, 0.75), "walk", None),
        ((0.0, 0.5, 0.63, 0.13), "walk", "lateral"),
        ((0.0, 0.5, 0.59, 0.09), "trot", None),
        ((0.0, 0.09, 0.48, 0.57), "bound", None),
        ((0.0, 0.12, 0.48, 0.6), "gallop", "transverse"),
        ((0.0, 0.18, 0.6, 0.78), "gallop", "transverse"),
        ((0.0, 0.18, 0.78, 0.6), "gallop", "rotary"),
        ((0.0, 0.5, 0.35, 0.0), "irregular", None),
        ((0.0, 0.3, 0.0, 0.3), "irregular", None),
    ],
)
def test_textbook_gaits(phases: tuple[float, ...], name: str, sequence: str | None) -> None:
    gait = classify(phases, SURE)
    assert (gait.name, gait.sequence) == (name, sequence)


@pytest.mark.parametrize("shift", [0.0, 0.03, 0.5, 0.97])
def test_the_class_does_not_depend_on_where_the_cycle_begins(shift: float) -> None:
    trot = (np.array([0.0, 0.5, 0.5, 0.0]) + np.array([0.0, 0.02, -0.02, 0.01]) + shift) % 1.0
    assert classify(trot.tolist(), SURE).name == "trot"


def test_loose_phases_are_irregular_but_the_nearest_class_is_told() -> None:
    gait = classify((0.0, 0.5, 0.5, 0.0), (1.0, 0.9, 0.79, 1.0))
    assert (gait.name, gait.nearest, gait.distance) == ("irregular", "trot", 0.0)


def test_a_missing_phase_leaves_the_class_open() -> None:
    assert classify((0.0, 0.5, np.nan, 0.0), SURE).name is None


def test_distances_are_the_largest_deviation() -> None:
    distances = class_distances(np.array([[0.0, 0.5, 0.5, 0.07]]))
    assert distances["trot"][0] == pytest.approx(0.07)
    assert distances["pace"][0] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("phases", "expected"),
    [
        ((0.0, 0.5, 0.5, 0.0), 0.5),
        ((0.0, 0.5, 0.75, 0.25), 0.25),
        ((0.0, 0.5, 0.25, 0.75), 0.75),
        ((0.0, 0.5, 0.01, 0.49), 0.0),
    ],
)
def test_diagonality(phases: tuple[float, ...], expected: float) -> None:
    told = diagonality(phases)
    assert told is not None
    assert abs((told - expected + 0.5) % 1.0 - 0.5) < 1e-9


def strides(*touchdowns: float) -> Strides:
    time = np.array([round(each * S) for each in touchdowns], np.int64)
    return Strides(np.arange(len(time) - 1), time[:-1], time[:-1] + 1, time[1:])


def test_phases_are_taken_within_reference_strides_only() -> None:
    reference = strides(1.0, 2.0, 4.0)
    touchdown = np.array([0.5, 1.25, 2.5, 3.0, 4.0], np.float64)
    phases = phases_in(reference, (touchdown * S).astype(np.int64))
    assert phases.tolist() == [0.25, 0.25, 0.5]


def test_a_foot_in_step_has_one_phase_in_every_stride_though_its_touchdowns_straddle() -> None:
    reference = strides(1.0, 2.0, 3.0, 4.0)
    touchdown = (np.array([0.99, 2.01, 2.99, 4.01]) * S).astype(np.int64)
    phases = phases_by_stride(reference, touchdown)
    assert (np.abs((phases + 0.5) % 1.0 - 0.5) < 0.02).all()


def test_a_stride_without_touchdowns_has_no_phase() -> None:
    assert np.isnan(phases_by_stride(strides(1.0, 2.0), np.array([9 * S]))).all()


def test_four_places_make_a_quadruped_in_any_order() -> None:
    corners = [("back", "left"), ("front", "right"), ("front", "left"), ("back", "right")]
    assert quadruped(corners) == (2, 1, 0, 3)
    assert quadruped([*corners[:3], None]) is None
    assert quadruped([*corners, ("middle", "left")]) is None
