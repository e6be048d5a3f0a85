"""Tasks for one log of many: small objects that can be sent to another process.

Each imports its command when it is called, so that a command need not load the others.
"""

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location
from dogbot_logtool.results import Figures
from dogbot_logtool.run.runner import OnProgress

if TYPE_CHECKING:
    from dogbot_logtool.reader.containers.loss import Damage
    from dogbot_logtool.report.dataset import Entry, Tables
    from dogbot_logtool.results import Conversion, LogInfo, Measurement
    from dogbot_logtool.robot.options import (
        ConvertOptions,
        PlotOptions,
        StatsOptions,
        TopicOptions,
    )

_CHECKS_AT_ONCE: Final = 16


@dataclass(frozen=True, slots=True)
class Describe:
    """`info` of a log."""

    options: "TopicOptions"
    all_frames: bool = False
    """Read every transform."""
    jobs: int = 1
    """How many batches are read at once."""

    def __call__(self, log: Location, on_progress: OnProgress | None) -> "LogInfo":
        """Describe it."""
        from dogbot_logtool.commands.info import describe  # noqa: PLC0415

        return describe(
            log, self.options, all_frames=self.all_frames, jobs=self.jobs, progress=on_progress
        )


@dataclass(frozen=True, slots=True)
class Convert:
    """`convert` of a log."""

    options: "ConvertOptions"

    def __call__(self, task: "ConversionTask", on_progress: OnProgress | None) -> "Conversion":
        """Convert it."""
        from dogbot_logtool.commands.convert import convert  # noqa: PLC0415

        overwrite = self.options.overwrite or task.target_was_free
        options = replace(self.options, overwrite=overwrite)
        return convert(task.log, task.target, options, on_progress)


@dataclass(frozen=True, slots=True)
class ConversionTask:
    """A log to convert."""

    log: Location
    target: Location
    target_was_free: bool
    """The target did not exist when the call began: if it exists now, a worker that was lost wrote
    it, and it may be replaced."""


def conversion_tasks(
    pairs: Sequence[tuple[Location, Location]], *, may_repeat: bool
) -> list[ConversionTask]:
    """Make a task of each log, after a look at which outputs exist.

    Args:
        pairs: logs and outputs.
        may_repeat: a log may be begun more than once.
    """
    if not may_repeat:
        return [ConversionTask(log, target, target_was_free=False) for log, target in pairs]
    from concurrent.futures import ThreadPoolExecutor  # noqa: PLC0415 - takes long

    with ThreadPoolExecutor(_CHECKS_AT_ONCE) as pool:
        free = pool.map(_is_free, [target for _, target in pairs])
        return [
            ConversionTask(*pair, target_was_free)
            for pair, target_was_free in zip(pairs, free, strict=True)
        ]


def _is_free(target: Location) -> bool:
    if isinstance(target, Path):
        return not os.path.lexists(target)
    return not storage.asked(target, lambda: target.fs.exists(target.path))


def figures_of(
    measured: "Measurement", *, whole: bool = False, as_json: bool = True, detail: bool = True
) -> Figures:
    """Return what is reported of a log.

    Args:
        measured: what was measured of it.
        whole: with the whole measurement.
        as_json: with its JSON.
        detail: that has curves and lists of times.
    """
    from dogbot_logtool.core.checks.voids import void_patterns  # noqa: PLC0415
    from dogbot_logtool.report.documents import stats_json  # noqa: PLC0415
    from dogbot_logtool.report.table_file import stride_table  # noqa: PLC0415
    from dogbot_logtool.report.verdict import summary_row  # noqa: PLC0415

    intervals = [foot.record.median_interval_s for foot in measured.stats.feet]
    return Figures(
        summary_row(measured),
        stats_json(measured, detail=detail) if as_json else {},
        stride_table(measured.stats, void_patterns(measured.findings)),
        max((each for each in intervals if each is not None), default=0.0),
        measured.facts.robot,
        measured.damage,
        measured if whole else None,
    )


@dataclass(frozen=True, slots=True)
class Measure:
    """`stats` of a log."""

    options: "StatsOptions"
    drawing: "PlotOptions | None" = None
    """The figure to draw; None: none."""
    whole: bool = False
    """Whether to return all results, with the base's path and every stance."""
    as_json: bool = True
    """Whether to return the results as JSON."""
    detail: bool = True
    """Whether the JSON has curves and lists of times."""

    def __call__(self, log: Location, on_progress: OnProgress | None) -> Figures:
        """Measure it."""
        from dogbot_logtool.commands.stats import measure  # noqa: PLC0415

        measured = measure(log, self.options, on_progress)
        figures = figures_of(measured, whole=self.whole, as_json=self.as_json, detail=self.detail)
        if self.drawing is None:
            return figures
        from dogbot_logtool.commands.plot import write_plot  # noqa: PLC0415

        drawn = write_plot(measured, self.drawing)
        return replace(figures, drawn=drawn)


@dataclass(frozen=True, slots=True)
class MeasureForDataset:
    """`export --dataset` of a log."""

    options: "StatsOptions"

    def __call__(self, entry: "Entry", on_progress: OnProgress | None) -> "MeasuredEntry":
        """Measure a log."""
        from dogbot_logtool.commands.stats import measure  # noqa: PLC0415
        from dogbot_logtool.report.dataset import log_tables  # noqa: PLC0415
        from dogbot_logtool.report.table_file import stride_table  # noqa: PLC0415

        measured = measure(entry.location, self.options, on_progress)
        tables = log_tables(measured.metrics, stride_table(measured.stats))
        return MeasuredEntry(tables, measured.damage)


@dataclass(frozen=True, slots=True)
class MeasuredEntry:
    """A log that was measured for a dataset."""

    tables: "Tables"
    damage: "Damage"
