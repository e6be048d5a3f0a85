"""One call of a command: its logs, what works on them, results, damage, exit code.

Damage is said first, and quietness does not hide it. A bad log does not stop the others.
"""

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, Protocol, TypeVar

import click

from dogbot_logtool.cli import note, say, say_damage
from dogbot_logtool.errors import DAMAGED, CallError, LogtoolError
from dogbot_logtool.io.output import whole_file
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.io.storage import valid_unicode, without_secrets
from dogbot_logtool.option import options_of
from dogbot_logtool.options import JobOptions, MeasureOptions, QuietOptions
from dogbot_logtool.report.text.progress import ProgressBars
from dogbot_logtool.run.inputs import LogSet, find_logs
from dogbot_logtool.run.runner import Command, Failure, Runner, SerialRunner, runner_for

if TYPE_CHECKING:
    from dogbot_logtool.reader.containers.loss import Damage
    from dogbot_logtool.results import Figures


class OfALog(Protocol):
    """A result that tells what could not be read of its log."""

    @property
    def damage(self) -> "Damage":
        """What could not be read."""


Result = TypeVar("Result", bound=OfALog)
Options = TypeVar("Options", bound=Any)


class Call:
    """Collects the outcome of each log of a call."""

    def __init__(self, options: QuietOptions) -> None:
        """Begin.

        Raises:
            CallError: see `check_robot_options`.
        """
        if getattr(options, "set", None) or getattr(options, "foot", None):
            from dogbot_logtool.robot.robot import check_robot_options  # noqa: PLC0415 - seldom

            check_robot_options(options)
        self._quiet = options.quiet
        self._scheduler: str | None = getattr(options, "scheduler", None)
        self._results: list[dict[str, Any]] = []
        self._codes: set[int] = set()
        self._notes: list[str] = []
        self.failures: list[tuple[str, str]] = []
        """Names of the logs and directories that could not be used, and why."""

    def logs(self, words: Iterable[str]) -> LogSet:
        """Find logs; directories that cannot be searched are failures.

        Raises:
            CallError: a word names nothing.
        """
        log_set = find_logs(words, for_workers=self._scheduler is not None)
        for name, sentence in log_set.failures:
            self._add_failure(name, sentence, LogtoolError.exit_code)
        if log_set.left_out:
            many = "log was" if log_set.left_out == 1 else "logs were"
            self._note(f"{log_set.left_out} annotated {many} left out; a glob names them, too")
        return log_set

    def joined_logs(self, options: Options) -> tuple[LogSet, Options]:
        """Find the logs; with --join the first stands for all, and the others in the options."""
        log_set = self.logs(options.logs)
        if not (options.join and log_set.logs[1:]):
            return log_set, options
        first, *others = log_set.logs
        joined = tuple(other.path for other in others)
        return log_set._replace(logs=(first,)), replace(options, joined=joined)

    def each(
        self,
        work: Callable[..., Result],
        options: JobOptions,
        items: Sequence[object],
        names: Sequence[str],
        command: Command | None = None,
    ) -> Iterator[Result]:
        """Work on all logs; yield the results in order, after their damage was said.

        A failure is reported, and is an outcome.

        Args:
            work: is called with an item, `options` and `progress`.
            options: of the work.
            items: what it is done to.
            names: of the items.
            command: whose work it is, for `runner_for`; None: one item after the other, here.
        """
        runner: Runner[Result] = SerialRunner(options.jobs)
        if command is not None:
            runner = runner_for(command, len(items), options.jobs, self._scheduler)
        work = partial(work, options=replace(options, jobs=runner.jobs))
        bars = ProgressBars(names, visible=not self._quiet)
        with closing(runner), bars:
            outcomes = runner.run(work, items, bars)
            for name, outcome in zip(names, outcomes, strict=True):
                if isinstance(outcome, Failure):
                    self._add_failure(name, outcome.sentence, outcome.exit_code)
                else:
                    self.add_damage(outcome.damage)
                    yield outcome

    def measured(self, logs: LogSet, options: MeasureOptions) -> "Iterator[Figures]":
        """Measure logs whose metrics are judged or compared."""
        from dogbot_logtool.commands.tasks import figures  # noqa: PLC0415 - of some commands

        return self.each(figures, options, logs.paths, logs.names, "stats")

    def sides(self, logs: Sequence[LogSet], options: MeasureOptions) -> "list[list[Figures]]":
        """Measure the logs of each side; exit where nothing of one could be measured."""
        found = [[*self.measured(each, options)] for each in logs]
        self._results += [{}] * sum(map(len, found))
        if not all(found):
            self.finish()
        return found

    def add_damage(self, damage: "Damage") -> None:
        """Say what was lost of a log, if anything was; the exit code tells, too."""
        self._codes.add(damage.exit_code)
        if damage.losses:
            say_damage(damage.line)

    def add(self, result: dict[str, Any], exit_code: int = 0) -> None:
        """Take the result of a log, and what the exit code is beside its damage."""
        self._results.append(result)
        self._codes.add(exit_code)

    def add_unchanged(self, logs: Sequence[tuple[str, int]]) -> None:
        """Take logs, by name and exit code, whose results are there already."""
        for name, exit_code in logs:
            self.add({}, exit_code)
            if exit_code == DAMAGED:
                say_damage(f"{name}: was damaged when it was measured, and is unchanged")
        if logs:
            many = "log is" if len(logs) == 1 else "logs are"
            self._note(f"{len(logs)} {many} there already, unchanged")

    def _add_failure(self, name: str, sentence: str, exit_code: int) -> None:
        """Take a failure, with its sentence as it may be shown."""
        sentence = without_secrets(valid_unicode(sentence))
        self.failures.append((name, sentence))
        self.add({"input": name, "error": sentence}, exit_code)

    @property
    def has_results(self) -> bool:
        """Whether something could be done for some log."""
        return len(self._results) > len(self.failures)

    def _note(self, text: str) -> None:
        """Keep a note for the end: damage is said before it."""
        if not self._quiet:
            self._notes.append(text)

    def finish(self, *, as_json: bool = False, exit_code: int = 0) -> NoReturn:
        """Print the notes, the results if wanted and what failed; exit: failure outranks damage.

        Args:
            as_json: print the results, one object for one log.
            exit_code: of what was found in the results of several logs together.
        """
        self._codes.add(exit_code)
        for text in self._notes:
            note(text)
        count = len(self._results)
        if as_json:
            results = self._results[0] if count == 1 else self._results
            click.echo(to_json(results, indent=2))
        if self.failures and count == 1:
            say(self.failures[0][1])
        elif self.failures:
            say(f"{len(self.failures)} of {count} logs could not be done")
            from dogbot_logtool.report.text.console import diagnostics  # noqa: PLC0415
            from dogbot_logtool.report.text.written_text import print_failures  # noqa: PLC0415

            print_failures(diagnostics(), self.failures)
        sys.exit(next((code for code in (1, 2, DAMAGED) if code in self._codes), 0))


def refuse_given(options: object, names: Iterable[str], why: str) -> None:
    """Refuse options that have no meaning beside others.

    Raises:
        CallError: one of these names is given.
    """
    record: Any = type(options)
    for each in options_of(record):
        if each.name in names and getattr(options, each.name) != each.default:
            raise CallError(f"{each.words} {why}")


def write(content: bytes, target: Path | None, *, overwrite: bool) -> None:
    """Write a result to a file; without one, print it."""
    if target is None:
        click.echo(content.decode(), nl=False)
    else:
        with whole_file(target, overwrite=overwrite) as file:
            file.write(content)
