"""Values that look like feet, and values that do not."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.robot.feet.content import judge_content

TIME = np.arange(600) * 10_000_000
PHASE = TIME / 1e9


def samples(values: NDArray[np.floating[Any]]) -> list[Samples]:
    """Values of some feet, (n, feet), as forces."""
    parts = []
    for foot, column in enumerate(values.T):
        force = np.zeros((len(column), 3))
        force[:, 2] = column
        parts.append(of_foot(foot, TIME[: len(column)], force))
    return parts


def of_foot(foot: int, time: NDArray[np.int64], force: NDArray[np.float64]) -> Samples:
    nothing, nowhere = np.zeros(len(time), np.int64), np.full((len(time), 3), np.nan)
    touches = (force != 0.0).any(axis=1)
    number = np.full(len(time), foot)
    return Samples(number, time, nothing, touches, force, nothing > 0, nothing, nowhere, nowhere)


def trot() -> NDArray[np.bool_]:
    """Two pairs, each down for 60 % of a second."""
    return np.stack([(PHASE + 0.5 * (foot in {1, 2})) % 1.0 < 0.6 for foot in range(4)], axis=1)


def test_a_walk_is_recognised_with_its_reasons() -> None:
    down = trot()
    found = judge_content(samples(down * 100.0 / down.sum(axis=1)[:, None]))
    assert found is not None
    assert found.points >= 7
    assert not found.is_contact
    text = "; ".join(found.reasons)
    assert "go on and off" in text
    assert "in turns: at least one is on 100%" in text
    assert "of 100, as a weight does" in text


def test_flags_are_contacts() -> None:
    found = judge_content(samples(trot() * 1.0))
    assert found is not None
    assert found.is_contact
    assert found.points == 4


@pytest.mark.parametrize("name", ["constant", "swings_about_zero", "same"])
def test_what_is_no_feet(name: str) -> None:
    values = {
        "constant": np.ones((600, 4)) * [40.0, 41.0, 42.0, 43.0],
        "swings_about_zero": np.sin(2.0 * np.pi * PHASE[:, None] + np.arange(4)),
        "same": np.repeat(trot()[:, :1] * 50.0, 4, axis=1),
    }[name]
    found = judge_content(samples(values))
    assert found is None or found.points <= 0


def test_too_few_samples_say_nothing() -> None:
    assert judge_content(samples(trot()[:10] * 1.0)) is None


def changes(foot: int, down: NDArray[np.bool_]) -> Samples:
    """A foot's contact when it begins and when it ends."""
    rows = np.flatnonzero(np.diff(down.astype(np.int8), prepend=-1))
    force = np.outer(down[rows], (0.0, 0.0, 1.0))
    return of_foot(foot, TIME[rows], force)


def test_contacts_that_are_published_on_change_are_recognised() -> None:
    found = judge_content([changes(foot, down) for foot, down in enumerate(trot().T)])
    assert found is not None
    assert found.is_contact
    assert found.points >= 6
    assert "published on change" in "; ".join(found.reasons)


def test_few_changes_say_nothing() -> None:
    few = [changes(foot, down[:300]) for foot, down in enumerate(trot().T)]
    assert judge_content(few) is None
