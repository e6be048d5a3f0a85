"""Sample logs as they are measured: once for all tests that only look at what comes out."""

from functools import cache
from pathlib import Path

import dogbot_logtool as dl
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.pipeline.options import StatsOptions
from dogbot_logtool.results import Measurement


@cache
def measured(log: Path, options: StatsOptions = StatsOptions()) -> Measurement:  # noqa: B008 - frozen
    """Measure a log, as the commands do."""
    return measure(log, options)


@cache
def walk_of(log: Path) -> dl.Walk:
    """Measure a log, as `import dogbot_logtool` does."""
    return dl.measure(log)
