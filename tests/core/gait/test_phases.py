import numpy as np
import pytest

from dogbot_logtool.core.gait.classes import diagonality, limb_phases, phases_by_stride, phases_in
from dogbot_logtool.core.gait.strides import Strides

S = 1_000_000_000


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
    found = diagonality(phases)
    assert found is not None
    assert abs((found - expected + 0.5) % 1.0 - 0.5) < 1e-9


def test_limb_phases_are_those_of_each_side() -> None:
    assert limb_phases((0.0, 0.5, 0.8, 0.2)) == pytest.approx((0.2, 0.3))
