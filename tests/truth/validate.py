"""Write what `stats` makes of logs whose truth is known: a page, and a table with a row a log.

    python -m tests.truth.validate

Real logs with labelled events are those in the folder that LOGTOOL_LABELLED names: NAME.mcap or
NAME.bag beside NAME.events.json. Without it, their part of the page stays as it is.
"""

import csv
import json
import os
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Final

import numpy as np

import dogbot_logtool as dl
from tests.paths import ROOT
from tests.truth.cases import groups
from tests.truth.geometry import Floats
from tests.truth.judging import faults, judge
from tests.truth.outcome import measured_log, nearest, outcome
from tests.truth.physics import BARE, write_log
from tests.truth.test_without_sensors import ROBOTS, SOURCES, force_error_bw

REACH_S: Final = 0.15
_SUFFIX: Final = ".events.json"


def labelled_rows(folder: Path) -> Iterator[tuple[str, ...]]:
    """Yield log, foot, contact fraction, touchdowns and lift-offs.

    Args:
        folder: NAME.mcap or NAME.bag beside NAME.events.json, which holds for each foot
            ``heel_strike_s`` and ``toe_off_s``: seconds since the log's start.
    """
    for file in sorted(folder.rglob(f"*{_SUFFIX}")):
        stem = file.name.removesuffix(_SUFFIX)
        log = next(path for path in file.parent.glob(f"{stem}.*") if path != file)
        found = measured_log(log).json
        for foot, events in json.loads(file.read_text(encoding="utf-8")).items():
            strikes, offs = np.array(events["heel_strike_s"]), np.array(events["toe_off_s"])
            ends = np.append(offs, found["log"]["duration_s"])[np.searchsorted(offs, strikes)]
            true = (ends - strikes).sum() / found["log"]["duration_s"]
            told = found["feet"][foot]
            fractions = f"{true:.3f} → {_number(told['contact_fraction'], 3)}"
            late = _late(strikes, told["touchdown_s"]), _late(offs, told["lift_off_s"])
            yield log.name, foot, fractions, *late


def _late(true: Floats, found: Sequence[float]) -> str:
    """Tell how many events are found, but for the first and the last, and how late."""
    inner = true[1:-1]
    errors = (nearest(np.array(found), inner) - inner) * 1e3
    errors = errors[np.abs(errors) <= 1e3 * REACH_S]
    if not len(errors):
        return f"0 of {len(inner)}"
    spread = f"{errors.mean():+.0f} ± {errors.std():.0f} ms, at most {np.abs(errors).max():.0f} ms"
    return f"{len(errors)} of {len(inner)}, {spread}"


PAGE: Final = ROOT / "docs" / "validation.md"
TABLE: Final = ROOT / "docs" / "validation.csv"
REAL: Final = "## Real logs with labelled events\n"
_HEAD: Final = """# Validation

What `stats --json` and the verdict of `report` make of logs whose truth is known. This page is
written by `make validate`; [validation.csv](validation.csv) has a row for each log, and
`tests/truth/` the logs and the tolerances.

Closed-form logs come from a walker that shares no code with the program: every touchdown, lift-off,
force and pose is a formula, and the vertical impulse of all feet over whole strides is the weight
times the time exactly. Each kind of log adds one fault of sensors, clocks or worlds. A figure is
*right* within its tolerance, or *null* with a finding that names the cause; anything else is
**wrong**.
"""
_BARE: Final = """
## Logs without foot sensors

Joint states, an inertial unit and a robot description of robots in a physics engine (MuJoCo): what
is estimated of contact, base and forces, against what the engine did. Of a real Unitree Go1 that
trots, with 25 s of joints and its own foot forces, time in contact in a stride is 0.54 by the
motion of its legs, and 0.64 by the forces, whose filter prolongs contact.
"""
_COLUMNS: Final = ("subject", "log", "right", "null", "wrong", "data quality", "warnings")


def main() -> None:
    """Write the page and the table."""
    subjects: list[Sequence[object]] = []
    logs = odd = 0
    with tempfile.TemporaryDirectory() as folder, TABLE.open("w", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(_COLUMNS)
        for subject, cases in groups().items():
            statuses: Counter[str] = Counter()
            for case in cases:
                recording = case.record()
                found = outcome(recording, Path(folder))
                judged = judge(case, recording, found)
                statuses.update(each.status for each in judged)
                wrong = "; ".join(f"{each.figure} {each.status}" for each in faults(judged))
                right = sum(each.status == "right" for each in judged)
                null = ", ".join(each.figure for each in judged if each.status == "null")
                warnings = ", ".join(sorted(set(found.warnings())))
                row = subject, case.name, right, null, wrong, found.quality, warnings
                table.writerow(row)
                logs, odd = logs + 1, odd + bool(wrong)
            rest = statuses["wrong"] + statuses["unexplained"]
            subjects.append((subject, len(cases), statuses["right"], statuses["null"], rest))
    counted = f"Of {logs} kinds of closed-form logs {logs - odd} are right, or null with the cause"
    columns = "subject", "logs", "figures right", "null, cause named", "wrong"
    closed = f"{_HEAD}\n{counted} named.\n\n{_table(columns, subjects)}"
    PAGE.write_text(f"{closed}{without_sensors()}{_real()}", "utf-8")


def without_sensors() -> str:
    """Return the part about logs without foot sensors and odometry."""
    columns = (
        "gait",
        "estimated from",
        "found",
        "time in contact",
        "speed, m/s",
        "impulse / weight",
        "error of vertical forces, body weights rms",
    )
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, run in ROBOTS.items():
            truth = run()
            for source, change in SOURCES.items():
                path = write_log(Path(folder) / "log.mcap", truth.telling(change), **BARE)
                walk = dl.measure(path)
                stats = walk.stats
                feet = [foot["contact_fraction"] for foot in stats["feet"].values()]
                speed = stats["base"]["forward_speed_mps"]
                ratio = stats["forces"]["vertical_impulse_over_weight"]
                down = f"{truth.touching.mean():.2f} → {np.mean(feet):.2f}"
                cells = name, source.replace("_", " "), stats["gait"]["name"], down
                went = f"{truth.speed_mps:.3f} → {speed:.3f}"
                error = None if ratio is None else force_error_bw(walk, truth)
                forces = _number(ratio, 2), _number(error, 2)
                rows.append((*cells, went, *forces))
    return f"{_BARE}\n{_table(columns, rows)}"


def _real() -> str:
    folder = os.environ.get("LOGTOOL_LABELLED")
    if not folder:
        _, found, kept = (PAGE.read_text("utf-8") if PAGE.exists() else "").partition(REAL)
        return f"\n{REAL}{kept}" if found else ""
    columns = ("log", "foot", "contact fraction", "touchdowns", "lift-offs")
    words = "\nWithout any option but the feet's topics; events but the first and the last.\n\n"
    return f"\n{REAL}{words}{_table(columns, labelled_rows(Path(folder)))}"


def _number(value: float | None, decimals: int) -> str:
    return "null" if value is None else f"{value:.{decimals}f}"


def _table(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table of Markdown."""
    first, *others = (f"| {' | '.join(map(str, cells))} |\n" for cells in (columns, *rows))
    return f"{first}|{'---|' * len(columns)}\n{''.join(others)}"


if __name__ == "__main__":
    main()
