"""Measuring the logs of commands that compare two runs, or two groups of runs."""

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dogbot_logtool.cli.outcomes import Outcomes
    from dogbot_logtool.results import Figures
    from dogbot_logtool.robot.options import StatsOptions
    from dogbot_logtool.run.inputs import LogSet
    from dogbot_logtool.run.runner import Runner


def measured_side(
    outcomes: "Outcomes", log_set: "LogSet", options: "StatsOptions"
) -> "list[Figures]":
    """Measure the logs of one side.

    Args:
        outcomes: takes what each log comes to.
        log_set: the logs.
        options: of measuring; `jobs` is for all of them.
    """
    from dogbot_logtool.commands.tasks import Measure  # noqa: PLC0415
    from dogbot_logtool.run.choice import runner_for  # noqa: PLC0415

    runner: Runner[Figures] = runner_for("stats", len(log_set.paths), options.jobs, None)
    outcomes.mention_left_out(log_set)
    work = Measure(replace(options, jobs=runner.jobs))
    figures = []
    for done in outcomes.of(runner, work, log_set.paths, log_set.names):
        outcomes.add(done.json)
        figures.append(done)
    return figures
