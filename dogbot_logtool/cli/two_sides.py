"""Options and arguments of commands that compare two runs, or two groups of runs."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from dogbot_logtool.cli.outcomes import Outcomes, say, say_damaged
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import DAMAGED

if TYPE_CHECKING:
    from dogbot_logtool.io.storage import Location
    from dogbot_logtool.pipeline.options import StatsOptions
    from dogbot_logtool.results import Figures
    from dogbot_logtool.run.inputs import LogSet
    from dogbot_logtool.run.runner import Runner


@dataclass(frozen=True, slots=True)
class Side:
    """The logs of one side, measured."""

    logs: "Sequence[Location]"
    figures: "list[Figures]"
    failed: bool
    """Whether some log could not be measured; that was said."""

    @property
    def exit_code(self) -> int:
        """0: all is sound; 1: some log could not be measured; 3: some log was damaged."""
        return 1 if self.failed else max((each.exit_code for each in self.figures), default=0)


def measured_side(log_set: "LogSet", options: "StatsOptions", *, quiet: bool) -> Side:
    """Measure the logs of one side; say which cannot be, and how many are damaged.

    Args:
        log_set: the logs.
        options: of measuring; `jobs` is for all of them.
        quiet: no progress, and no notes.
    """
    from dogbot_logtool.commands.tasks import Measure  # noqa: PLC0415
    from dogbot_logtool.run.choice import runner_for  # noqa: PLC0415

    runner: Runner[Figures] = runner_for("stats", len(log_set.paths), options.jobs, None)
    outcomes = Outcomes(quiet=quiet)
    outcomes.mention_left_out(log_set)
    work = Measure(replace(options, jobs=runner.jobs))
    figures = list(outcomes.of(runner, work, log_set.paths, log_set.names))
    for name, sentence in outcomes.failures:
        say(f"{name}: {sentence}" if not sentence.startswith(name) else sentence)
    if damaged := sum(each.exit_code == DAMAGED for each in figures):
        say_damaged(damaged, "`stats` says what was lost")
    return Side(log_set.paths, figures, failed=bool(outcomes.failures))


def exit_code_of(sides: Sequence[Side]) -> int:
    """Return what measuring all sides comes to: a failure outranks damage."""
    codes = {side.exit_code for side in sides}
    return next((code for code in (1, DAMAGED) if code in codes), 0)
