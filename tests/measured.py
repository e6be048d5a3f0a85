"""Sample logs as they are measured: once for all tests that only look at what comes out."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np

import dogbot_logtool as dl
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.core.analysis import judge
from dogbot_logtool.core.arrays import Flags, Ints
from dogbot_logtool.core.contact.stances import Cut, Stances
from dogbot_logtool.core.metrics import Log
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.loss import SOUND, Damage
from dogbot_logtool.results import Measurement


@cache
def measured(log: Path, options: MeasureOptions = MeasureOptions()) -> Measurement:  # noqa: B008 - frozen
    """Measure a log, as the commands do."""
    return measure(log, options)


def measurement_of(
    walk: Walk,
    *,
    path: str = "walk.bag",
    damage: Damage = SOUND,
    findings: Sequence[Finding] = (),
) -> Measurement:
    """Judge a walk, which a test may have changed, as that of some log."""
    lost = [Finding("LOST", damage.text)] if damage.losses else []
    log = Log(path, "ROS 1 bag", "ros1", 0.0, 10.0, 100, damage.messages, damage.bytes)
    return Measurement(judge(walk, log, [*lost, *findings]), damage)


@cache
def walk_of(log: Path) -> dl.Walk:
    """Measure a log, as `import dogbot_logtool` does."""
    return dl.measure(log)


def in_stance(stances: Stances, time: Ints) -> Flags:
    """(n,) whether measured stances hold some times; one that the log ends has its last sample."""
    begun = np.searchsorted(stances.touchdown, time, side="right") - 1
    behind = np.where(stances.cut == Cut.LOG_END, stances.liftoff + 1, stances.liftoff)
    ends = np.append(behind, np.iinfo(np.int64).min)
    held: Flags = time < ends[begun]
    return held


@cache
def measured_contact(
    log: Path,
    foot: str,
    options: MeasureOptions = MeasureOptions(),  # noqa: B008 - frozen
) -> Mapping[int, bool] | None:
    """Whether a foot is in contact by log time of its samples, ns; None: that is not known."""
    found = next(each for each in measured(log, options).walk.feet if each.name == foot)
    if not found.contact_known:
        return None
    record = found.record
    down = in_stance(record.stances, record.track.time)
    return dict(zip(record.track.log_time.tolist(), down.tolist(), strict=True))
