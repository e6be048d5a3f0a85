"""The functions of `import dogbot_logtool`; options are named as on the command line."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from dogbot_logtool.api.keywords import (
    ConvertKeywords,
    MeasureKeywords,
    PathOrName,
    RobotKeywords,
    checked,
    convert_options,
    refuse_bad_values,
    several,
    stats_options,
    topic_options,
)
from dogbot_logtool.io.storage import Location, location

# Each function loads what it needs: who only measures need not load the writer.
if TYPE_CHECKING:
    from dogbot_logtool.api.walk import Walk
    from dogbot_logtool.comparison.outcome import Comparison
    from dogbot_logtool.comparison.rules.judge import Judgement
    from dogbot_logtool.comparison.walks.two_runs import GaitComparison
    from dogbot_logtool.results import Conversion, LogInfo


def measure(log: PathOrName, **options: Unpack[MeasureKeywords]) -> "Walk":
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

    path, chosen = _location(log), stats_options(options)
    return Walk(path, stats.measure(path, chosen), chosen)


def convert(
    log: PathOrName, target: PathOrName, **options: Unpack[ConvertKeywords]
) -> "Conversion":
    """Write the annotated MCAP of a log: what `dogbot-logtool convert` does.

    Raises:
        CallError: no such file, a target that may not be written, or an option that does not fit.
        LogError: the log cannot be read, or has nothing to annotate.
        LogtoolError: the target cannot be written.
    """
    from dogbot_logtool.commands import convert as command  # noqa: PLC0415

    return command.convert(_location(log), _location(target), convert_options(options))


def info(
    log: PathOrName, *, frames: bool = False, jobs: int = 1, **options: Unpack[RobotKeywords]
) -> "LogInfo":
    """Tell what is in a log, what is used for what, and what is wrong with it.

    Args:
        log: its path or URL.
        frames: read every transform: the result's `frames`.
        jobs: batches that are worked on at once then.
        options: see `RobotKeywords`.

    Raises:
        CallError: no such file, or a topic that the log does not have.
        LogError: it is no log.
    """
    from dogbot_logtool.commands.info import describe  # noqa: PLC0415

    refuse_bad_values({"jobs": jobs})
    topics = topic_options(checked(options, RobotKeywords))
    return describe(_location(log), topics, all_frames=frames, jobs=jobs)


def compare(
    expected: PathOrName,
    actual: PathOrName,
    *,
    atol: float | None = None,
    rtol: float | None = None,
    tolerances: PathOrName | None = None,
    ignore: Sequence[str] = (),
    topics: Sequence[str] = (),
    max_differences: int = 20,
) -> "Comparison":
    """Compare two logs, or two results of `stats --json`; `exit_code` is 0 where they agree.

    Raises:
        CallError: an option is wrong, or a file is missing, unreadable, or not like the other.
    """
    from dogbot_logtool.commands import compare as command  # noqa: PLC0415
    from dogbot_logtool.robot.options import CompareOptions  # noqa: PLC0415

    tolerated = {name: value for name, value in (("atol", atol), ("rtol", rtol)) if value}
    refuse_bad_values(tolerated)
    chosen = CompareOptions(
        atol=atol,
        rtol=rtol,
        tolerances=None if tolerances is None else Path(tolerances),
        ignore=tuple(several(ignore)),
        topics=tuple(several(topics)),
        max_differences=max_differences,
    )
    return command.compare(Path(expected), Path(actual), chosen)


def compare_gait(
    first: PathOrName | Sequence[PathOrName],
    second: PathOrName | Sequence[PathOrName],
    **options: Unpack[MeasureKeywords],
) -> "GaitComparison":
    """Compare how the robot walks in two logs, or groups of logs: what `compare --gait` does.

    Raises:
        CallError: no such file, or an option that does not fit a log.
        LogError: one is no log, or has nothing to measure.
    """
    from dogbot_logtool.commands import compare_gait as command  # noqa: PLC0415
    from dogbot_logtool.commands.tasks import Measure  # noqa: PLC0415

    work = Measure(stats_options(options))
    sides = [[work(_location(log), None) for log in several(side)] for side in (first, second)]
    return command.compare_gait(*sides)


def check(
    log: PathOrName,
    limits: PathOrName,
    *,
    baseline: PathOrName | None = None,
    **options: Unpack[MeasureKeywords],
) -> "tuple[Judgement, ...]":
    """Judge a log by the rules of a file: what `dogbot-logtool check` does.

    Raises:
        CallError: a file is missing or not what it should be, or rules need a `baseline`.
        LogError: it is no log, or has nothing to measure.
    """
    from dogbot_logtool.commands import check as command  # noqa: PLC0415

    rules = command.read_limits(Path(limits), None if baseline is None else Path(baseline))
    return tuple(command.check(measure(log, **options).stats, rules))


def _location(path: PathOrName) -> Location:
    """Return the path or URL that was given."""
    return location(os.fspath(path))
