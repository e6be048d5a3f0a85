"""What is done to one log of many, here or in another process: `functools.partial` of these.

Each imports its command when it is called, so that a command need not load the others.
"""

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location
from dogbot_logtool.results import Figures
from dogbot_logtool.run.runner import OnProgress

if TYPE_CHECKING:
    from dogbot_logtool.options import MeasureOptions
    from dogbot_logtool.options.convert import Convert, ConvertOptions
    from dogbot_logtool.report.dataset import Entry, MeasuredEntry
    from dogbot_logtool.results import Conversion

_CHECKS_AT_ONCE: Final = 16
ConversionTask = tuple[Location, Location, bool]
"""A log to convert, its output, and whether that may be replaced."""


def figures(
    log: Location,
    *,
    options: "MeasureOptions",
    whole: bool = False,
    as_json: bool = True,
    detail: bool = True,
    progress: OnProgress | None = None,
) -> Figures:
    """Measure a log; return what is reported of it.

    Args:
        log: the log.
        options: of measuring.
        whole: with the whole measurement.
        as_json: with its JSON.
        detail: that has curves and lists of times.
        progress: called with bytes done and bytes in all.
    """
    from dogbot_logtool.commands.stats import measure  # noqa: PLC0415
    from dogbot_logtool.report.documents import stats_json  # noqa: PLC0415
    from dogbot_logtool.report.tables import stride_table  # noqa: PLC0415
    from dogbot_logtool.report.verdict import summary_row  # noqa: PLC0415

    measured = measure(log, options, progress)
    intervals = [foot.record.median_interval_s for foot in measured.walk.feet]
    return Figures(
        summary_row(measured),
        stats_json(measured, detail=detail) if as_json else {},
        stride_table(measured.walk),
        max((each for each in intervals if each is not None), default=0.0),
        measured.damage,
        measured if whole else None,
    )


def convert_task(
    task: ConversionTask, *, options: "ConvertOptions", progress: OnProgress | None = None
) -> "Conversion":
    """Convert a log."""
    from dogbot_logtool.commands.convert import convert  # noqa: PLC0415

    log, target, overwrite = task
    return convert(log, target, replace(options, overwrite=overwrite), progress)


def conversion_tasks(
    pairs: Sequence[tuple[Location, Location]], options: "Convert"
) -> list[ConversionTask]:
    """Make a task of each log and its output.

    Of several, one may be begun again after its worker was lost: what was not there when the call
    began may be replaced then.
    """
    if options.overwrite or (len(pairs) == 1 and options.scheduler is None):
        return [(*pair, options.overwrite) for pair in pairs]
    from concurrent.futures import ThreadPoolExecutor  # noqa: PLC0415 - takes long

    with ThreadPoolExecutor(_CHECKS_AT_ONCE) as pool:
        free = pool.map(_is_free, [target for _, target in pairs])
        return [(*pair, is_free) for pair, is_free in zip(pairs, free, strict=True)]


def _is_free(target: Location) -> bool:
    if isinstance(target, Path):
        return not os.path.lexists(target)
    return not storage.exists(target)


def measure_entry(
    entry: "Entry", *, options: "MeasureOptions", progress: OnProgress | None = None
) -> "MeasuredEntry":
    """Measure a log for a dataset."""
    from dogbot_logtool.commands.stats import measure  # noqa: PLC0415
    from dogbot_logtool.report.dataset import MeasuredEntry  # noqa: PLC0415
    from dogbot_logtool.report.dataset_tables import log_tables  # noqa: PLC0415
    from dogbot_logtool.report.tables import stride_table  # noqa: PLC0415

    measured = measure(entry.location, options, progress)
    tables = log_tables(measured.metrics, stride_table(measured.walk))
    return MeasuredEntry(entry, tables, measured.damage)
