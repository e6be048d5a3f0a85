"""The functions of `import dogbot_logtool`; options are named as on the command line."""

import os
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from dogbot_logtool.api.keywords import Log, PathOrName, joined, several, takes, takes_with_two
from dogbot_logtool.io.storage import location
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.check import BaselineOptions
from dogbot_logtool.options.compare import CompareOptions
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.options.info import InfoOptions

# Each function loads what it needs: who only measures need not load the writer.
if TYPE_CHECKING:
    from dogbot_logtool.api.recording import Recording
    from dogbot_logtool.api.walk import Walk
    from dogbot_logtool.comparison.judge import Judgement
    from dogbot_logtool.comparison.outcome import Comparison
    from dogbot_logtool.comparison.walks import GaitComparison
    from dogbot_logtool.results import Conversion, LogInfo


@takes(MeasureOptions)
def measure(log: Log, options: MeasureOptions) -> "Walk":
    """Measure a walk: what `dogbot-logtool stats` does.

    >>> import dogbot_logtool as dl
    >>> walk = dl.measure("sample_logs/dogbot_trot.bag")
    >>> walk.gait.name
    'trot'
    >>> walk
    <Walk sample_logs/dogbot_trot.bag: trot, 24 strides>
    >>> round(float(walk.strides["duty_factor"][0]), 3)
    0.716

    Raises:
        CallError: no such file, or an option that does not fit the log.
        LogError: it is no log, or has nothing to measure.
    """
    from dogbot_logtool.api.walk import Walk  # noqa: PLC0415
    from dogbot_logtool.commands import stats  # noqa: PLC0415

    path, options = joined(log, options)
    return Walk(path, stats.measure(path, options), options)


@takes(MeasureOptions)
def read(log: Log, options: MeasureOptions) -> "Recording":
    """Read a log as columns, uncorrected: what `measure` measures.

    >>> import dogbot_logtool as dl
    >>> recording = dl.read("sample_logs/dogbot_trot.bag")
    >>> recording.feet["front_left"].force.shape
    (2001, 3)

    Raises:
        CallError: no such file, or an option that does not fit the log.
        LogError: it is no log, or has nothing to measure.
    """
    from dogbot_logtool.api.recording import read_columns  # noqa: PLC0415

    return read_columns(*joined(log, options))


@takes_with_two(ConvertOptions)
def convert(log: Log, target: PathOrName, options: ConvertOptions) -> "Conversion":
    """Write the annotated MCAP of a log: what `dogbot-logtool convert` does.

    Raises:
        CallError: no such file, a target that may not be written, or an option that does not fit.
        LogError: the log cannot be read, or has nothing to annotate.
        LogtoolError: the target cannot be written.
    """
    from dogbot_logtool.commands import convert as command  # noqa: PLC0415

    path, options = joined(log, options)
    return command.convert(path, location(os.fspath(target)), options)


@takes(InfoOptions)
def info(log: Log, options: InfoOptions) -> "LogInfo":
    """Tell what is in a log, what is used for what, and what is wrong with it.

    Raises:
        CallError: no such file, or a topic that the log does not have.
        LogError: it is no log.
    """
    from dogbot_logtool.commands.info import describe  # noqa: PLC0415

    return describe(*joined(log, options))


@takes_with_two(CompareOptions)
def compare(expected: PathOrName, actual: PathOrName, options: CompareOptions) -> "Comparison":
    """Compare two logs, or two results of `stats --json`; `exit_code` is 0 where they agree.

    Raises:
        CallError: an option is wrong, or a file is missing, unreadable, or not like the other.
    """
    from dogbot_logtool.commands import compare as command  # noqa: PLC0415

    return command.compare(Path(expected), Path(actual), options)


@takes_with_two(MeasureOptions)
def compare_gait(first: Log, second: Log, options: MeasureOptions) -> "GaitComparison":
    """Compare how the robot walks in two logs, or groups of logs: what `compare --gait` does.

    Raises:
        CallError: no such file, or an option that does not fit a log.
        LogError: one is no log, or has nothing to measure.
    """
    from dogbot_logtool.commands.tasks import figures  # noqa: PLC0415
    from dogbot_logtool.comparison.walks import compare_walks  # noqa: PLC0415

    work = partial(figures, options=options)
    return compare_walks(*([work(log) for log in several(side)] for side in (first, second)))


@takes_with_two(BaselineOptions)
def check(log: Log, limits: PathOrName, options: BaselineOptions) -> "tuple[Judgement, ...]":
    """Judge a log by the rules of a file: what `dogbot-logtool check` does.

    Args:
        log: the log.
        limits: the TOML file of rules.
        options: see the keywords.

    Raises:
        CallError: a file is missing or not what it should be, or rules need a `baseline`.
        LogError: it is no log, or has nothing to measure.
    """
    from dogbot_logtool.commands import check as command  # noqa: PLC0415
    from dogbot_logtool.commands.tasks import figures  # noqa: PLC0415

    rules = command.read_limits(Path(limits), options.baseline)
    path, chosen = joined(log, options)
    return tuple(command.check(figures(path, options=chosen).json, rules))
