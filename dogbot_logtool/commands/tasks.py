"""What is done to one log of many: small objects that can be sent to another process.

Each imports its command when it is called, so that a command need not load the others.
"""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location
from dogbot_logtool.results import Figures
from dogbot_logtool.run.relay import Progress

if TYPE_CHECKING:
    from dogbot_logtool.pipeline.options import (
        ConvertOptions,
        PlotOptions,
        StatsOptions,
        TopicOptions,
    )
    from dogbot_logtool.report.parquet import Dataset, Entry
    from dogbot_logtool.results import Conversion, LogInfo, Measurement

_CHECKS_AT_ONCE: Final = 16


@dataclass(frozen=True, slots=True)
class Describe:
    """`info` of a log."""

    options: "TopicOptions"
    all_frames: bool = False
    """Read every transform."""
    jobs: int = 1
    """How many batches are read at once."""

    def __call__(self, log: Location, tell: Progress | None) -> "LogInfo":
        """Describe it."""
        from dogbot_logtool.commands.info import describe  # noqa: PLC0415

        return describe(
            log, self.options, all_frames=self.all_frames, jobs=self.jobs, progress=tell
        )


@dataclass(frozen=True, slots=True)
class Convert:
    """`convert` of a log."""

    options: "ConvertOptions"

    def __call__(self, order: "Order", tell: Progress | None) -> "Conversion":
        """Convert it."""
        from dogbot_logtool.commands.convert import convert  # noqa: PLC0415

        overwrite = self.options.overwrite or order.was_free
        options = replace(self.options, overwrite=overwrite)
        return convert(order.log, order.target, options, tell)


@dataclass(frozen=True, slots=True)
class Order:
    """A log that is to be converted."""

    log: Location
    target: Location
    was_free: bool
    """Nothing was there when the call began: what is there now, a worker wrote that was lost before
    it could tell, and may be replaced by the same."""


def orders(pairs: Sequence[tuple[Location, Location]], *, may_repeat: bool) -> list[Order]:
    """See which outputs are free.

    Args:
        pairs: logs and outputs.
        may_repeat: a log may be begun more than once.
    """
    if not may_repeat:
        return [Order(log, target, was_free=False) for log, target in pairs]
    with ThreadPoolExecutor(_CHECKS_AT_ONCE) as pool:
        free = pool.map(_is_free, [target for _, target in pairs])
        return [Order(*pair, was_free) for pair, was_free in zip(pairs, free, strict=True)]


def _is_free(target: Location) -> bool:
    if isinstance(target, Path):
        return not os.path.lexists(target)
    return not storage.asked(target, lambda: target.fs.exists(target.path))


def figures_of(measured: "Measurement", *, whole: bool = False) -> Figures:
    """Return what is reported of a log, and the whole measurement if wanted."""
    from dogbot_logtool.report.stats_json import stats_json  # noqa: PLC0415
    from dogbot_logtool.report.stats_summary import summary_row  # noqa: PLC0415
    from dogbot_logtool.report.stride_table import stride_table  # noqa: PLC0415

    stats, facts = measured.stats, measured.facts
    return Figures(
        summary_row(stats, facts),
        stats_json(stats, facts),
        stride_table(stats),
        facts.robot,
        measured.exit_code,
        measured if whole else None,
    )


@dataclass(frozen=True, slots=True)
class Measure:
    """`stats` of a log."""

    options: "StatsOptions"
    drawing: "PlotOptions | None" = None
    """A figure to be drawn of it."""
    whole: bool = False
    """Whether to return all there is, base's path and every stance included."""
    window: tuple[float, float] | None = None
    """s since the log's start, what is to be shown; None: that is chosen."""

    def __call__(self, log: Location, tell: Progress | None) -> Figures:
        """Measure it."""
        from dogbot_logtool.commands.stats import measure  # noqa: PLC0415
        from dogbot_logtool.pipeline.time_span import refuse_window  # noqa: PLC0415

        measured = measure(log, self.options, tell)
        if self.window is not None:
            refuse_window(self.window, (measured.stats.end - measured.stats.origin) / 1e9)
        figures = figures_of(measured, whole=self.whole)
        if self.drawing is None:
            return figures
        from dogbot_logtool.commands.plot import write_plot  # noqa: PLC0415

        drawn = write_plot(log, self.options, measured, self.drawing, tell)
        return replace(figures, drawn=drawn)


@dataclass(frozen=True, slots=True)
class Keep:
    """`stats` of a log whose figures go into a dataset."""

    measure: Measure
    dataset: "Dataset"

    def __call__(self, entry: "Entry", tell: Progress | None) -> Figures:
        """Measure a log and keep its figures."""
        figures = self.measure(entry.place, tell)
        self.dataset.keep(figures, entry)
        return figures
