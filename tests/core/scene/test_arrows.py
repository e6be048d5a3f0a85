"""The rotation of arrows; their colours and the rest are in tests of the conversion."""

import math
from typing import Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.scene.arrows import turn_x_to

Vector = tuple[float, float, float]


def turned_x(quaternion: object) -> list[float]:
    """Rotate (1, 0, 0) by a unit quaternion x, y, z, w: the first column of its matrix."""
    x, y, z, w = np.asarray(quaternion).tolist()
    return [w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)]


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


@settings(max_examples=150, deadline=None)
@given(unit_vectors)
def test_the_rotation_is_the_shortest_that_turns_x_to_the_direction(direction: Vector) -> None:
    (quaternion,) = turn_x_to(np.array([direction]))

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
    quaternions = turn_x_to(
        np.array([(end, beside, 0), (end, 0, -beside), (end, beside, beside)], np.float64)
    )

    for quaternion in quaternions:
        assert turned_x(quaternion) == pytest.approx([end, 0, 0], abs=1e-15)
