"""Measures dogbot-logtool against what one would use instead, side by side, as whole processes.

    python benchmarks/run.py [--repeats N] [--logs FOLDER] [--json FILE] [--only TEXT] [--guard]

The logs are made first, or taken from the folder if they are there. The contenders of a task take
turns, so that a busy machine is busy for all of them. Times are medians; what takes long runs once.
Results go to `benchmarks/results/`: `results.json` (or FILE), `table.md` and, if matplotlib is
there, `results.png`. With --guard only a minute's worth is measured, and the exit code is 1 if a
ratio of processor times is far from what it was: a coarse guard for CI. With --only, tasks are
measured whose names hold the text, and nothing is written.
"""

import argparse
import datetime as dt
import json
import math
import os
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

from tasks import (
    FOLDER,
    HERE,
    HEXAPOD,
    LOGS,
    OURS,
    SHORT_LOGS,
    Contender,
    Task,
    guarded_tasks,
    ratios,
    script,
    tasks,
)

RESULTS: Final = HERE / "results"
_ENVIRONMENT: Final = {
    name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"
}
"""What is installed is compiled once; a checkout must not be compiled anew at every start."""
_SLOW_S: Final = 20.0
"""A contender that takes longer runs once."""


@dataclass(frozen=True)
class Result:
    """Medians of a contender's runs."""

    task: str
    name: str
    seconds: float
    cpu_seconds: float
    peak_mib: float
    times_ours: float


@dataclass(frozen=True)
class Run:
    """One process."""

    seconds: float
    cpu_seconds: float
    peak_mib: float


def run(command: Sequence[str | Path]) -> Run:
    """Run a process to its end.

    Raises:
        SystemExit: it fails.
    """
    start = time.perf_counter()
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=_ENVIRONMENT
    )
    output = process.stdout.read() if process.stdout else b""
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - start
    if os.waitstatus_to_exitcode(status):
        raise SystemExit(f"{command} failed: {output.decode(errors='replace')[-2000:]}")
    if str(command[1]).endswith("bound.py"):
        # It keeps its own time: loading what it works on is no part of the bound.
        seconds, cpu = (float(word) for word in output.split())
    else:
        cpu = usage.ru_utime + usage.ru_stime
    return Run(seconds, cpu, usage.ru_maxrss / 1024)


def measure(task: Task, repeats: int, *, with_memory: bool) -> list[Result]:
    """Let the contenders take turns."""
    runs: dict[str, list[Run]] = {one.name: [] for one in task.contenders}
    peaks: dict[str, float] = {}
    for one in task.contenders:
        if one.processes and with_memory:
            from memory import peak_mib  # noqa: PLC0415 - needs the extra `bench`

            make_room(one)
            peaks[one.name] = peak_mib(one.command)
    for _ in range(repeats):
        for one in task.contenders:
            if not runs[one.name] or runs[one.name][0].seconds < _SLOW_S:
                make_room(one)
                runs[one.name].append(run(one.command))
    ours = statistics.median(one.seconds for one in runs[task.contenders[0].name])
    results = []
    for name, done in runs.items():
        seconds = statistics.median(one.seconds for one in done)
        results.append(
            Result(
                task=task.name,
                name=name,
                seconds=round(seconds, 3),
                cpu_seconds=round(statistics.median(one.cpu_seconds for one in done), 3),
                peak_mib=round(peaks.get(name, max(one.peak_mib for one in done)), 1),
                times_ours=round(seconds / ours, 2),
            )
        )
        print(f"{task.name:34} {name:34} {seconds:8.3f} s  {results[-1].times_ours:7.2f} x")
    return results


def make_room(contender: Contender) -> None:
    """Remove what an earlier run wrote."""
    if contender.output is not None:
        contender.output.unlink(missing_ok=True)


def make_logs(folder: Path, *, guard: bool) -> None:
    """Make the logs that are not there yet."""
    wanted = {name: (*words, "dogbot") for name, words in LOGS.items()}
    wanted[HEXAPOD] = (60, "lz4", "hexapod")
    if guard:
        wanted = {name: wanted[name] for name in ("1.bag", "60.bag")}
    for name, (seconds, kind, robot) in wanted.items():
        if not (folder / name).exists():
            part = folder / f"part.{name}"
            run(script("make_log.py", part, str(seconds), kind, robot))
            part.rename(folder / name)
    if not guard and not (folder / FOLDER).exists():
        (folder / FOLDER).mkdir()
        for number in range(SHORT_LOGS):
            shutil.copy(folder / "1.bag", folder / FOLDER / f"log{number:03}.bag")


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """Serve a folder; give its URL."""
    with subprocess.Popen(script("serve.py", folder), stdout=subprocess.PIPE, text=True) as server:
        try:
            yield server.stdout.readline().strip() if server.stdout else ""
        finally:
            server.terminate()


def machine() -> str:
    """Say what this ran on."""
    cpu = platform.processor() or platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        cpu = next(line.partition(": ")[2] for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return f"{cpu}, {os.cpu_count()} cores, Python {platform.python_version()}"


def table(results: Sequence[Result]) -> str:
    """Return the results as a Markdown table."""
    lines = ["| task | | wall s | cpu s | peak MiB | time / ours |", "|---|---|--:|--:|--:|--:|"]
    task = ""
    for one in results:
        lines.append(
            f"| {one.task if one.task != task else ''} | {one.name} | {one.seconds:.2f} | "
            f"{one.cpu_seconds:.2f} | {one.peak_mib:.0f} | {one.times_ours:.2f} |"
        )
        task = one.task
    return "\n".join(lines) + "\n"


def plot(results: Sequence[Result], path: Path) -> None:
    """Draw the wall times, if matplotlib is there."""
    try:
        import matplotlib as mpl  # noqa: PLC0415

        mpl.use("Agg")
        from matplotlib import pyplot as plt  # noqa: PLC0415
    except ImportError:
        print("no plot: matplotlib is not installed")
        return
    labels = [f"{one.task}: {one.name}" for one in results]
    colours = ["tab:blue" if one.name.startswith(OURS) else "tab:gray" for one in results]
    figure, axes = plt.subplots(figsize=(10, 0.3 * len(results) + 1))
    axes.barh(labels, [one.seconds for one in results], color=colours)
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.set_xlabel("wall time, s")
    figure.savefig(path, dpi=100, bbox_inches="tight")


def guard(results: Sequence[Result]) -> int:
    """Print the ratios of processor times that are guarded; return 1 if one is beyond its limit."""
    broken = 0
    for ratio, value in ratios({(one.task, one.name): one.cpu_seconds for one in results}):
        kept = (ratio.least or 0.0) <= value <= (ratio.most or math.inf)
        broken += not kept
        print(f"{'kept  ' if kept else 'BROKEN'} {ratio.name}: {value} ({ratio.limit})")
    return int(broken > 0)


def write_results(results: Sequence[Result], facts: dict[str, object], target: Path) -> None:
    """Write what was measured: as JSON, a table and a picture."""
    found = dict(ratios({(one.task, one.name): one.seconds for one in results}))
    named = {ratio.name: value for ratio, value in found.items()}
    whole = {**facts, "ratios": named, "results": [asdict(one) for one in results]}
    target.write_text(json.dumps(whole, indent=1) + "\n", encoding="utf-8")
    lines = [f"- {name}: {value}" for name, value in named.items()]
    text = table(results) + "\n" + "\n".join(lines) + "\n"
    (RESULTS / "table.md").write_text(text, encoding="utf-8")
    plot(results, RESULTS / "results.png")


def main() -> int:
    """Measure everything and write the results; return the exit code."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--logs", type=Path, default=Path(tempfile.gettempdir()) / "dogbot_bench")
    parser.add_argument("--json", type=Path, default=RESULTS / "results.json")
    parser.add_argument("--only", metavar="TEXT")
    parser.add_argument("--guard", action="store_true")
    options = parser.parse_args()
    options.logs.mkdir(parents=True, exist_ok=True)
    RESULTS.mkdir(exist_ok=True)
    make_logs(options.logs, guard=options.guard)
    results: list[Result] = []
    facts: dict[str, object] = {
        "date": dt.datetime.now(dt.UTC).date().isoformat(),
        "machine": machine(),
        "load_before": round(os.getloadavg()[0], 2),
        "repeats": options.repeats,
    }
    with tempfile.TemporaryDirectory(dir=options.logs) as out, served(options.logs) as url:
        chosen = (
            guarded_tasks(options.logs, Path(out))
            if options.guard
            else tasks(options.logs, Path(out), url)
        )
        for task in chosen:
            if options.only is None or options.only in task.name:
                results.extend(measure(task, options.repeats, with_memory=not options.guard))
    if options.only is not None:
        return 0
    if not options.guard:
        write_results(results, facts, options.json)
    return guard(results)


if __name__ == "__main__":
    sys.exit(main())
