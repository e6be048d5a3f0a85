"""Which axis is forward, by the way of a base that drives along its own x axis."""

import pytest

from dogbot_logtool.core.base.axes import axis_by_motion
from dogbot_logtool.core.base.motion import base_motion
from tests.core.base.test_base_motion import circle, track


@pytest.mark.parametrize(
    ("guessed", "moves"), [("+x", None), ("-x", None), ("+y", "+x"), ("-y", "+x")]
)
def test_a_way_to_a_side_is_forward(guessed: str, moves: str | None) -> None:
    """One that goes backward contradicts nothing."""
    assert axis_by_motion(base_motion(track(circle()), guessed), guessed) == moves


def test_a_short_way_tells_nothing() -> None:
    assert axis_by_motion(base_motion(track(circle(seconds=0.8)), "+y"), "+y") is None


def test_a_metre_to_a_side_is_enough() -> None:
    assert axis_by_motion(base_motion(track(circle(seconds=2.0)), "+y"), "+y") == "+x"
