"""When labels are written and removed."""

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.scene.arrows import pressure_arrows
from dogbot_logtool.core.scene.labels import RATE_HZ, Labels, foot_labels

MS = 1_000_000
STEP_MS = 4


def samples(down: list[bool], first_ms: int = 0) -> Samples:
    """One foot's samples, 250 a second."""
    count = len(down)
    time = (np.arange(count) * STEP_MS + first_ms) * MS
    load = np.where(down, 50.0, 0.0)
    return Samples(
        foot=np.zeros(count, np.int64),
        log_time=time,
        stamp=time,
        in_contact=np.array(down),
        force=np.column_stack([load * 0.0, load * 0.0, load]),
        in_world=np.ones(count, np.bool_),
        points=np.array(down).astype(np.int64),
        position=np.where(np.array(down)[:, None], 1.0, np.nan) * np.ones((count, 3)),
        normal=np.full((count, 3), np.nan),
    )


def labels(told: Samples, last_ms: int | None = None, *, was_down: bool = False) -> Labels:
    arrows, _ = pressure_arrows(told)
    last = {} if last_ms is None else {0: last_ms * MS}
    return foot_labels(told, arrows, last, {0} if was_down else set())


def test_a_label_is_written_at_ticks_and_removed_at_once() -> None:
    down = [True] * 30 + [False] * 30
    found = labels(samples(down))
    shown = (found.log_time[found.shown] / MS).tolist()
    gone = (found.log_time[~found.shown] / MS).tolist()
    period = 1000.0 / RATE_HZ
    assert shown == [0.0, 52.0, 100.0]
    # Lifted between two ticks; then again at each tick.
    assert gone == [30.0 * STEP_MS, 152.0, 200.0]
    assert gone[0] % period != 0.0


def test_it_does_not_matter_where_batches_end() -> None:
    down = [True] * 30 + [False] * 30
    whole = labels(samples(down))
    for cut in (1, 29, 30, 31, 59):
        parts = [
            labels(samples(down[:cut])),
            labels(samples(down[cut:], cut * STEP_MS), (cut - 1) * STEP_MS, was_down=down[cut - 1]),
        ]
        for name in ("log_time", "shown"):
            joined = np.concatenate([getattr(part, name) for part in parts])
            np.testing.assert_array_equal(joined, getattr(whole, name))
