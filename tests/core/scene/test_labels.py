"""When labels are written and removed."""

import numpy as np

from dogbot_logtool.core.scene.labels import RATE_HZ, foot_labels
from tests.core.scene.drawn_feet import NOWHERE, foot_of

STEP_MS = 4
DOWN = [True] * 30 + [False] * 30
FOOT = foot_of(
    [(STEP_MS * row, 50.0 if down else 0.0, (1.0, 1.0, 1.0)) for row, down in enumerate(DOWN)]
)


def test_a_label_is_written_at_ticks_and_removed_at_once() -> None:
    found = foot_labels(FOOT, slice(0, len(DOWN)))
    shown = (found.log_time[found.shown] / 1e6).tolist()
    gone = (found.log_time[~found.shown] / 1e6).tolist()
    period = 1000.0 / RATE_HZ
    assert shown == [0.0, 52.0, 100.0]
    # Lifted between two ticks; then again at each tick.
    assert gone == [30.0 * STEP_MS, 152.0, 200.0]
    assert gone[0] % period != 0.0
    np.testing.assert_allclose(found.position[found.shown], [[1.0, 1.0, 0.9]] * 3)
    assert found.force[found.shown].tolist() == [50.0] * 3


def test_it_does_not_matter_where_spans_end() -> None:
    whole = foot_labels(FOOT, slice(0, len(DOWN)))
    for cut in (0, 1, 29, 30, 31, 59):
        parts = [foot_labels(FOOT, slice(0, cut)), foot_labels(FOOT, slice(cut, len(DOWN)))]
        for name in ("log_time", "shown"):
            joined = np.concatenate([getattr(part, name) for part in parts])
            np.testing.assert_array_equal(joined, getattr(whole, name))


def test_a_load_without_a_place_has_no_label() -> None:
    foot = foot_of([(10.0 * row, 50.0, NOWHERE) for row in range(9)])
    assert not foot_labels(foot, slice(0, 9)).shown.any()
