"""Results, damage and exit code of one call: what all commands say in the same way.

Damage is said first, and quietness does not hide it. A bad log does not stop the others.
"""

import sys
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Final, NoReturn, Protocol, TypeVar

import click

from dogbot_logtool.errors import DAMAGED, LogtoolError
from dogbot_logtool.io.plain_json import readable_json
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import valid_unicode, without_secrets

if TYPE_CHECKING:
    from dogbot_logtool.reader.containers.loss import Damage
    from dogbot_logtool.run.inputs import LogSet
    from dogbot_logtool.run.runner import Runner, Work


class OfALog(Protocol):
    """A result that tells what could not be read of its log."""

    @property
    def damage(self) -> "Damage":
        """What could not be read."""


Result = TypeVar("Result", bound=OfALog)

_NEW_LINE: Final = "\n  "
"""Begins a line of a list in an error's sentence; names from logs cannot begin lines of ours."""


class Outcomes:
    """Collects the outcome of each log."""

    def __init__(self, *, quiet: bool = False) -> None:
        """Begin.

        Args:
            quiet: no progress, and no notes.
        """
        self._quiet = quiet
        self._results: list[dict[str, Any]] = []
        self._codes: set[int] = set()
        self._failed: list[tuple[str, str]] = []
        self._notes: list[str] = []

    def of(
        self,
        runner: "Runner[Result]",
        work: "Work[Result]",
        items: Sequence[object],
        names: Sequence[str],
        on_outcome: Callable[[int, Result | None, str], None] | None = None,
    ) -> Iterator[Result]:
        """Work on all logs; yield the results in order, after their damage was said.

        A failure is reported, and is an outcome.

        Args:
            runner: works on them; is closed at the end.
            work: what is done.
            items: what it is done to.
            names: of the items.
            on_outcome: called with the number of each item, its result and, where there is none,
                the sentence on why.
        """
        from dogbot_logtool.report.text.progress import ProgressBars  # noqa: PLC0415
        from dogbot_logtool.run.runner import Failure  # noqa: PLC0415

        bars = ProgressBars(names, shown=not self._quiet)
        with runner, bars:
            outcomes = runner.run(work, items, bars)
            for number, (name, outcome) in enumerate(zip(names, outcomes, strict=True)):
                if isinstance(outcome, Failure):
                    sentence = self._add_failure(name, outcome.sentence, outcome.exit_code)
                    if on_outcome is not None:
                        on_outcome(number, None, sentence)
                    continue
                self.add_damage(outcome.damage)
                if on_outcome is not None:
                    on_outcome(number, outcome, "")
                yield outcome

    def add_damage(self, damage: "Damage") -> None:
        """Say what was lost of a log, if anything was; the exit code tells, too."""
        self._codes.add(damage.exit_code)
        if damage.losses:
            _say_damage(damage.line)

    def add(self, result: dict[str, Any], exit_code: int = 0) -> None:
        """Take the result of a log, and what the exit code is beside its damage."""
        self._results.append(result)
        self._codes.add(exit_code)

    def add_unchanged(self, logs: Sequence[tuple[str, int]]) -> None:
        """Take logs, by name and exit code, whose results are there already."""
        for name, exit_code in logs:
            self.add({"input": name, "unchanged": True}, exit_code)
            if exit_code == DAMAGED:
                _say_damage(f"{name}: was damaged when it was measured, and is unchanged")
        if logs:
            many = "log is" if len(logs) == 1 else "logs are"
            self._note(f"{len(logs)} {many} there already, unchanged")

    def _add_failure(self, name: str, sentence: str, exit_code: int) -> str:
        """Take a failure; return its sentence as it may be shown."""
        sentence = without_secrets(valid_unicode(sentence))
        self._failed.append((name, sentence))
        self.add({"input": name, "error": sentence}, exit_code)
        return sentence

    @property
    def failures(self) -> list[tuple[str, str]]:
        """Names of the logs and directories that could not be used, and why."""
        return self._failed

    @property
    def has_results(self) -> bool:
        """Whether something could be done for some log."""
        return len(self._results) > len(self._failed)

    def mention_left_out(self, log_set: "LogSet") -> None:
        """Note which annotated logs were left out; directories that cannot be read are failures."""
        for name, sentence in log_set.failures:
            self._add_failure(name, sentence, LogtoolError.exit_code)
        if log_set.left_out:
            many = "log was" if log_set.left_out == 1 else "logs were"
            self._note(f"{log_set.left_out} annotated {many} left out; a glob names them, too")

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
        if as_json:
            results = self._results
            click.echo(readable_json(results[0] if len(results) == 1 else results))
        if len(self._results) == 1 and self._failed:
            say(self._failed[0][1])
        elif self._failed:
            self._print_failures()
        sys.exit(next((code for code in (1, 2, DAMAGED) if code in self._codes), 0))

    def _print_failures(self) -> None:
        """Print a table of what could not be done."""
        from dogbot_logtool.report.text.console import diagnostics, print_sentence  # noqa: PLC0415

        say(f"{len(self._failed)} of {len(self._results)} logs could not be done")
        width = min(max(len(printable(name)) for name, _ in self._failed), 60)
        for name, sentence in self._failed:
            first, *_ = sentence.removeprefix(f"{name}: ").split(_NEW_LINE)
            line = f"  {printable(name):<{width}}  {printable(first)}"
            print_sentence(diagnostics(), line, indent=4)


def say_error(error: LogtoolError) -> None:
    """Print an error's sentence on stderr."""
    say(str(error))


def _say_damage(sentence: str) -> None:
    """Print on stderr what was lost: one line, whatever the names in it."""
    from dogbot_logtool.report.text.console import diagnostics, print_sentence  # noqa: PLC0415

    text = printable(without_secrets(valid_unicode(sentence)))
    print_sentence(diagnostics(), ("damage: ", "red"), text)


def say(sentence: str) -> None:
    """Print the sentence of an error on stderr; what it lists stands in indented lines below."""
    from dogbot_logtool.report.text.console import diagnostics, print_command, print_sentence  # noqa: PLC0415

    first, *others = map(printable, without_secrets(sentence).split(_NEW_LINE))
    label = "error: "
    print_sentence(diagnostics(), (label, "red"), first, indent=len(label))
    for line in others:
        if line.startswith("dogbot-logtool "):
            print_command(diagnostics(), line, 2)
        else:
            print_sentence(diagnostics(), f"  {line}", indent=4)


def note(sentence: str) -> None:
    """Print what is good to know on stderr."""
    from dogbot_logtool.report.text.console import diagnostics, print_note  # noqa: PLC0415

    print_note(diagnostics(), sentence)
