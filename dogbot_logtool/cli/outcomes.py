"""Results and exit code of one call over several logs: a bad log does not stop the rest."""

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

import click

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.printable import printable


class Outcomes:
    """Collects what became of each log."""

    def __init__(self) -> None:
        self._results: list[dict[str, Any]] = []
        self._codes: list[int] = []

    @contextmanager
    def of(self, source: Path) -> Iterator[None]:
        """Work on a log; an error is said, and becomes its outcome."""
        try:
            yield
        except LogtoolError as error:
            say_error(error)
            self.add({"input": str(source), "error": str(error)}, error.exit_code)

    def add(self, result: dict[str, Any], exit_code: int) -> None:
        """Take the result of a log."""
        self._results.append(result)
        self._codes.append(exit_code)

    def finish(self, *, as_json: bool) -> NoReturn:
        """Print the results if wanted, one object for one log; exit: failure outranks damage."""
        if as_json:
            results = self._results
            click.echo(json.dumps(results[0] if len(results) == 1 else results, indent=2))
        sys.exit(next((code for code in (1, 2, 3) if code in self._codes), 0))


def say_error(error: LogtoolError) -> None:
    """Print an error's sentence on stderr."""
    text = "\n".join(printable(line) for line in str(error).split("\n"))
    click.echo(click.style("error: ", fg="red") + text, err=True)
