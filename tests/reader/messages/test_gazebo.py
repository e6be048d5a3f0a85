"""Gazebo's contact sensors as columns: physics steps, bodies and links by their names."""

import numpy as np
import pytest

from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.gazebo import foot_sides, newest_step, step_times
from tests.reader.decode.oracle import texts_of


def told_at(seconds: int) -> str:
    pair = "my geom:dogbot::leg::foot   other geom:ground_plane::link::collision"
    return f"Debug:  i:(0/1)     {pair}         time:{seconds}.000000000\n"


@pytest.mark.parametrize("info", ["", "no time here", "time12.5", "x" * 100, "time"])
def test_a_message_that_tells_no_time_is_one_step_and_is_counted(info: str) -> None:
    infos = [told_at(1), info, told_at(2), info, told_at(3)]
    owner = np.array([0, 0, 0, 1, 2], np.int64)

    newest, _, untimed = newest_step(step_times(texts_of(infos)), owner, np.zeros(3, np.int64))

    assert newest.tolist() == [True] * 5
    assert untimed == 1


@pytest.mark.parametrize(
    ("collision", "link"),
    [
        ("dogbot::front_left_lowerleg::lump__foot_collision_5", "front_left_lowerleg"),
        ("world::dogbot::leg::foot", "leg"),
        ("foot_collision", None),
    ],
)
def test_the_link_stands_in_the_collisions_name(collision: str, link: str | None) -> None:
    pair = texts_of([collision, "ground_plane::link::collision"])
    foot = Foot("front_left", "/x", collision=collision)
    _, links = foot_sides(pair.pick(np.array([0])), pair.pick(np.array([1])), np.array([0]), [foot])
    assert links == ({0: {link}} if link else {})
