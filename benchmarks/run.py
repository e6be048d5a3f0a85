"""Measures dogbot-logtool against what one would use instead, side by side, as whole processes.

    python benchmarks/run.py [--repeats N] [--logs FOLDER]

The logs are made first, or taken from the folder if they are there. The contenders of a task take
turns, so that a busy machine is busy for all of them. Times are medians. Results go to
`benchmarks/results/`: `results.json`, `table.md` and, if matplotlib is there, `results.png`.
"""

import argparse
import datetime as dt
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

from memory import peak_mib

HERE: Final = Path(__file__).parent
RESULTS: Final = HERE / "results"
LOGS: Final = {
    "1.bag": (1, "lz4"),
    "60.bag": (60, "lz4"),
    "600.bag": (600, "lz4"),
    "60_none.bag": (60, "none"),
    "60_bz2.bag": (60, "bz2"),
    "60_ros1.mcap": (60, "ros1"),
    "60_cdr.mcap": (60, "cdr"),
    "600_ros1.mcap": (600, "ros1"),
    "1GB.bag": (630, "none"),
}
"""Seconds, and how they are stored, by name. The last is for `info`: 1 GB, and not compressed."""
OURS: Final = "dogbot-logtool"
_ENVIRONMENT: Final = {
    name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"
}
"""What is installed is compiled once; a checkout must not be compiled anew at every start."""
BOUND: Final = "bound: the codecs alone"
LIBRARIES: Final = "libraries, message by message"
FORCES: Final = "rosbags, forces alone"


@dataclass(frozen=True)
class Contender:
    """A command that does a task."""

    name: str
    command: Sequence[str | Path]
    output: Path | None = None
    """Removed before each run: to replace a file costs a flush of it to the disk."""
    processes: bool = False
    """It works in several; their memory is measured together, in a run of its own."""


@dataclass(frozen=True)
class Task:
    """What is measured: the first contender is ours, to which the others are compared."""

    name: str
    contenders: Sequence[Contender]


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


def measure(task: Task, repeats: int) -> list[Result]:
    """Let the contenders take turns."""
    runs: dict[str, list[Run]] = {one.name: [] for one in task.contenders}
    peaks: dict[str, float] = {}
    for one in task.contenders:
        if one.processes:
            make_room(one)
            peaks[one.name] = peak_mib(one.command)
    for _ in range(repeats):
        for one in task.contenders:
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


def make_logs(folder: Path) -> None:
    """Make the logs that are not there yet."""
    for name, (seconds, kind) in LOGS.items():
        if not (folder / name).exists():
            part = folder / f"part.{name}"
            run([sys.executable, HERE / "make_log.py", part, str(seconds), kind])
            part.rename(folder / name)


def tool(*words: str | Path) -> list[str | Path]:
    """Return a command line of ours."""
    return [sys.executable, "-m", "dogbot_logtool", *words]


def script(name: str, *words: str | Path) -> list[str | Path]:
    """Return the command line of a script in this folder."""
    return [sys.executable, HERE / name, *words]


def pymcap(*words: str | Path) -> list[str | Path]:
    """Return a command line of pymcap-cli, from the same environment."""
    return [Path(sys.executable).with_name("pymcap-cli"), *words]


def convert_task(log: Path, out: Path, jobs: int, *, everything: bool = False) -> Task:
    """Convert a log, against its bound, the libraries, and a tool that only re-containerises."""
    ours, theirs = out / f"{log.name}.mcap", out / "theirs.mcap"
    words: list[str | Path] = ["convert", log, "-o", ours, "-q", "--jobs", str(jobs)]
    contenders = [
        Contender(f"{OURS} --jobs {jobs}", tool(*words), ours, processes=jobs > 1),
        Contender(BOUND, script("bound.py", log, ours, str(jobs))),
    ]
    if everything:
        copy = "bag2mcap" if log.suffix == ".bag" else "compress"
        contenders += [
            Contender(LIBRARIES, script("library_convert.py", log, theirs), theirs),
            Contender(f"pymcap-cli {copy} (copies only)", pymcap(copy, log, "-o", theirs), theirs),
        ]
    return Task(f"convert {log.name}, {jobs} at once", contenders)


def tasks(logs: Path, out: Path) -> list[Task]:
    """Return what is measured. Outputs of earlier tasks are inputs of later ones."""
    short, long = logs / "60.bag", logs / "600.bag"
    short_ros1, short_cdr = logs / "60_ros1.mcap", logs / "60_cdr.mcap"
    annotated = out / "60.bag.mcap"
    return [
        convert_task(logs / "1.bag", out, 2),
        convert_task(short, out, 2, everything=True),
        convert_task(long, out, 2, everything=True),
        convert_task(long, out, 1),
        convert_task(short_ros1, out, 2, everything=True),
        convert_task(short_cdr, out, 2, everything=True),
        convert_task(logs / "600_ros1.mcap", out, 2, everything=True),
        convert_task(logs / "60_none.bag", out, 2),
        convert_task(logs / "60_bz2.bag", out, 2),
        *(
            Task(
                f"stats {log.name}",
                [
                    Contender(OURS, tool("stats", log, "--json"), processes=True),
                    Contender(FORCES, script("library_stats.py", log)),
                ],
            )
            for log in (short, long)
        ),
        Task(
            "compare 60.bag.mcap",
            [
                Contender(OURS, tool("compare", annotated, annotated)),
                Contender("mcap, bytes alone", script("library_compare.py", annotated, annotated)),
            ],
        ),
        *(
            Task(
                f"info {name}",
                [
                    Contender(OURS, tool("info", logs / name)),
                    Contender("library's index", script("library_info.py", logs / name)),
                ],
            )
            for name in ("1GB.bag", "60_ros1.mcap")
        ),
        Task("--help", [Contender(OURS, tool("--help"))]),
    ]


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


def ratios(results: Sequence[Result]) -> dict[str, float]:
    """Return what the project promises itself, computed across tasks."""
    seconds = {(one.task, one.name): one.seconds for one in results}

    def convert(log: str, name: str = "", jobs: int = 2) -> float:
        return seconds[f"convert {log}, {jobs} at once", name or f"{OURS} --jobs {jobs}"]

    start = convert("1.bag")
    libraries = convert("600.bag", LIBRARIES)
    copying = convert("600.bag", "pymcap-cli bag2mcap (copies only)")
    found = {
        "libraries / ours, 10 min bag": libraries / convert("600.bag"),
        "libraries / ours, 10 min bag, one thread": libraries / convert("600.bag", jobs=1),
        "libraries / ours, 10 min MCAP": convert("600_ros1.mcap", LIBRARIES)
        / convert("600_ros1.mcap"),
        "libraries / ours, 1 min MCAP": convert("60_ros1.mcap", LIBRARIES)
        / convert("60_ros1.mcap"),
        "rosbags / ours, stats of the 10 min bag": seconds["stats 600.bag", FORCES]
        / seconds["stats 600.bag", OURS],
        "pymcap-cli / ours, 10 min bag": copying / convert("600.bag"),
        "ours / bound, 10 min bag": convert("600.bag") / convert("600.bag", BOUND),
        "10 min / 1 min": convert("600.bag") / convert("60.bag"),
        "10 min / 1 min, without the time of a 1 s log": (convert("600.bag") - start)
        / (convert("60.bag") - start),
    }
    return {what: round(ratio, 2) for what, ratio in found.items()}


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


def main() -> None:
    """Measure everything and write the results."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--logs", type=Path, default=Path(tempfile.gettempdir()) / "dogbot_bench")
    options = parser.parse_args()
    options.logs.mkdir(parents=True, exist_ok=True)
    RESULTS.mkdir(exist_ok=True)
    make_logs(options.logs)
    results: list[Result] = []
    load_before = os.getloadavg()[0]
    with tempfile.TemporaryDirectory(dir=options.logs) as out:
        for task in tasks(options.logs, Path(out)):
            results.extend(measure(task, options.repeats))
    facts = {
        "date": dt.datetime.now(dt.UTC).date().isoformat(),
        "machine": machine(),
        "load_before": round(load_before, 2),
        "repeats": options.repeats,
        "ratios": ratios(results),
        "results": [asdict(one) for one in results],
    }
    (RESULTS / "results.json").write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
    lines = [f"- {what}: {ratio}" for what, ratio in ratios(results).items()]
    text = table(results) + "\n" + "\n".join(lines) + "\n"
    (RESULTS / "table.md").write_text(text, encoding="utf-8")
    plot(results, RESULTS / "results.png")


if __name__ == "__main__":
    main()
