"""Two recordings, compared."""

from pathlib import Path

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.comparison.outcome import Comparison, Tally
from dogbot_logtool.options.compare import CompareOptions
from tests.comparison.recordings import Recording


class Pair:
    """Two recordings, written and compared."""

    def __init__(self, folder: Path) -> None:
        self.expected = folder / "expected.mcap"
        self.actual = folder / "actual.mcap"

    def write(self, expected: Recording, actual: Recording) -> None:
        expected.write(self.expected)
        actual.write(self.actual)

    def compare(self, options: CompareOptions = CompareOptions()) -> Comparison:  # noqa: B008
        return compare(self.expected, self.actual, options)

    def lines(
        self,
        expected: Recording,
        actual: Recording,
        options: CompareOptions = CompareOptions(),  # noqa: B008 - frozen
    ) -> list[str]:
        self.write(expected, actual)
        result = self.compare(options)
        assert result.same == (not result.differences)
        assert result.exit_code == (0 if result.same else 1)
        return [difference.line for difference in result.differences]


def tally(result: Comparison, name: str) -> Tally:
    return next(one for one in result.tallies if one.name == name)


def counts(one: Tally) -> tuple[int, int, int, int, int, int, int]:
    return (
        one.expected,
        one.actual,
        one.equal,
        one.within_tolerance,
        one.different,
        one.missing,
        one.extra,
    )
