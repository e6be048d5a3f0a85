"""The golden files: what this program makes of the sample logs, agreed on once.

`make golden` makes them anew and says what changed; `make test` makes them afresh in a temporary
folder and compares. Only annotations are kept, and of the long logs only a few strides, so that the
repository stays small.

    python sample_logs/golden.py
"""

import json
import shutil
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Final

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.comparison.outcome import counted
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.compare import CompareOptions
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.report.documents import stats_json

SAMPLES: Final = Path(__file__).parent
GOLDEN: Final = SAMPLES / "golden"
_STYLES: Final[tuple[str, ...]] = ("classic", "pressure", "force")
_ENCODINGS: Final[tuple[str, ...]] = ("foxglove", "ros1")
_SPANS_S: Final = {
    "dogbot_trot.bag": (1.0, 4.0),
    "dogbot_walk.mcap": (2.0, 4.5),
    "dogbot_troubled.bag": (None, None),
}


@dataclass(frozen=True, slots=True)
class GoldenLog:
    """Annotations of a sample log."""

    log: str
    style: str
    encoding: str

    @property
    def name(self) -> str:
        """File name."""
        return f"{Path(self.log).stem}.{self.style}.{self.encoding}.mcap"

    def make(self, folder: Path) -> Path:
        """Write the file into a folder."""
        start_s, end_s = _SPANS_S[self.log]
        options = ConvertOptions(
            style=self.style, encoding=self.encoding, copy=False, start=start_s, end=end_s
        )
        target = folder / self.name
        convert(SAMPLES / self.log, target, options)
        return target


@dataclass(frozen=True, slots=True)
class GoldenStats:
    """Figures of a sample log."""

    log: str

    @property
    def name(self) -> str:
        """File name."""
        return f"{Path(self.log).stem}.stats.json"

    def make(self, folder: Path) -> Path:
        """Write the file into a folder."""
        done = measure(SAMPLES / self.log, MeasureOptions())
        figures = stats_json(done)
        figures["log"]["path"] = self.log
        target = folder / self.name
        target.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
        return target


Case = GoldenLog | GoldenStats


def cases() -> Iterator[Case]:
    """Yield everything that is kept."""
    for log in _SPANS_S:
        for style, encoding in product(_STYLES, _ENCODINGS):
            yield GoldenLog(log, style, encoding)
        yield GoldenStats(log)


def main() -> int:
    """Make all golden files anew and print what changed."""
    GOLDEN.mkdir(exist_ok=True)
    changed = 0
    with tempfile.TemporaryDirectory() as folder:
        for case in cases():
            lines = _renew(GOLDEN / case.name, case.make(Path(folder)))
            changed += bool(lines)
            for line in lines:
                print(f"{case.name}: {line}")
    wanted = {case.name for case in cases()}
    for stray in sorted(file for file in GOLDEN.iterdir() if file.name not in wanted):
        print(f"{stray.name}: is no golden file any more; delete it")
    print(f"{changed} of {len(wanted)} golden files changed")
    return 0


def _renew(golden: Path, fresh: Path) -> list[str]:
    """Copy a file over a golden one that means something else; return what changed."""
    if not golden.exists():
        shutil.copy(fresh, golden)
        return ["is new"]
    found = compare(golden, fresh, CompareOptions(max_differences=0))
    if found.exit_code:
        shutil.copy(fresh, golden)
    damage = [f"was damaged: {each.text}" for each in found.damage]
    return damage + [f"{each.name}: {counted([each])}" for each in found.tallies if not each.same]


if __name__ == "__main__":
    sys.exit(main())
