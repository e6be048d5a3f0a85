"""What is measured, and against what."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from shlex import quote
from typing import Final

HERE: Final = Path(__file__).parent
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
HEXAPOD: Final = "60_hexapod.bag"
"""Six feet at 1 kHz, for a minute."""
FOLDER: Final = "100_short"
"""A folder of as many logs of a second."""
SHORT_LOGS: Final = 100
RULES: Final = """
[[rule]]
figure = "feet.*.duty_factor.median"
between = [0.1, 0.9]
"""
OURS: Final = "dogbot-logtool"
BOUND: Final = "bound: the codecs alone"
LIBRARIES: Final = "libraries, message by message"
FORCES: Final = "rosbags, forces alone"
NUMPY: Final = "python -c 'import numpy'"


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


def stats_task(log: Path) -> Task:
    """Measure a log, against reading its forces with rosbags."""
    return Task(
        f"stats {log.name}",
        [
            Contender(OURS, tool("stats", log, "--json"), processes=True),
            Contender(FORCES, script("library_stats.py", log)),
        ],
    )


def start_tasks(logs: Path, out: Path) -> list[Task]:
    """Return what a log of a second takes, which is start-up, against libraries and numpy."""
    log, target, theirs = logs / "1.bag", out / "start.mcap", out / "theirs.mcap"
    numpy = Contender(NUMPY, [sys.executable, "-c", "import numpy"])
    return [
        Task(
            "start: convert 1.bag",
            [
                Contender(OURS, tool("convert", log, "-o", target, "-q"), target),
                Contender(LIBRARIES, script("library_convert.py", log, theirs), theirs),
                numpy,
            ],
        ),
        Task("start: stats 1.bag", [Contender(OURS, tool("stats", log, "--json", "-q")), numpy]),
    ]


def folder_tasks(logs: Path, out: Path) -> list[Task]:
    """Return what a folder of short logs takes, against a shell loop of single calls."""
    folder, made, theirs = logs / FOLDER, out / FOLDER, out / "theirs.mcap"

    def loop(name: str, *words: str | Path) -> list[str | Path]:
        call = " ".join(quote(str(word)) for word in script(name))
        rest = " ".join(quote(str(word)) for word in words)
        return ["sh", "-ec", f'for log in {quote(str(folder))}/*; do {call} "$log" {rest}; done']

    return [
        Task(
            f"convert {FOLDER}",
            [
                Contender(OURS, tool("convert", folder, "-o", f"{made}/", "-q", "--overwrite")),
                Contender(f"{LIBRARIES}, a loop", loop("library_convert.py", theirs), theirs),
            ],
        ),
        Task(
            f"stats {FOLDER}",
            [
                Contender(OURS, tool("stats", folder, "-q")),
                Contender(f"{FORCES}, a loop", loop("library_stats.py")),
            ],
        ),
    ]


def output_tasks(log: Path, out: Path) -> list[Task]:
    """Return the commands that measure and write something else, against reading the forces."""
    rules, table, page = out / "rules.toml", out / "samples.csv", out / "page.html"
    rules.write_text(RULES, encoding="utf-8")
    forces = Contender(FORCES, script("library_stats.py", log))
    theirs = out / "theirs.csv"
    return [
        Task(f"check {log.name}", [Contender(OURS, tool("check", log, "--limits", rules)), forces]),
        Task(
            f"export {log.name}, samples",
            [
                Contender(OURS, tool("export", log, "--table", "samples", "-o", table), table),
                Contender(FORCES, script("library_stats.py", log, theirs), theirs),
            ],
        ),
        Task(
            f"report {log.name}", [Contender(OURS, tool("report", log, "-o", page), page), forces]
        ),
    ]


def info_tasks(logs: Path, url: str) -> list[Task]:
    """Return `info` of files, against the libraries' indices; over HTTP they are downloaded."""
    places = {name: logs / name for name in ("1GB.bag", "60_ros1.mcap")}
    far = {f"{name} over HTTP": f"{url}/{name}" for name in ("600.bag", "600_ros1.mcap")}
    return [
        Task(
            f"info {name}",
            [
                Contender(OURS, tool("info", place)),
                Contender("library's index", script("library_info.py", place)),
            ],
        )
        for name, place in {**places, **far}.items()
    ]


def tasks(logs: Path, out: Path, url: str) -> list[Task]:
    """Return what is measured. Outputs of earlier tasks are inputs of later ones.

    Args:
        logs: folder of the logs.
        out: folder for what is made.
        url: of a server of the logs.
    """
    short, long = logs / "60.bag", logs / "600.bag"
    annotated = out / "60.bag.mcap"
    return [
        *start_tasks(logs, out),
        convert_task(logs / "1.bag", out, 2),
        convert_task(short, out, 2, everything=True),
        convert_task(long, out, 2, everything=True),
        convert_task(long, out, 1),
        convert_task(logs / "60_ros1.mcap", out, 2, everything=True),
        convert_task(logs / "60_cdr.mcap", out, 2, everything=True),
        convert_task(logs / "600_ros1.mcap", out, 2, everything=True),
        convert_task(logs / "60_none.bag", out, 2),
        convert_task(logs / "60_bz2.bag", out, 2),
        convert_task(logs / HEXAPOD, out, 2, everything=True),
        *map(stats_task, (short, long, logs / HEXAPOD)),
        *folder_tasks(logs, out),
        *output_tasks(short, out),
        Task(
            "compare 60.bag.mcap",
            [
                Contender(OURS, tool("compare", annotated, annotated)),
                Contender("mcap, bytes alone", script("library_compare.py", annotated, annotated)),
            ],
        ),
        *info_tasks(logs, url),
        Task("--help", [Contender(OURS, tool("--help"))]),
    ]


def guarded_tasks(logs: Path, out: Path) -> list[Task]:
    """Return the few that CI measures."""
    short = logs / "60.bag"
    ours, theirs = out / "60.bag.mcap", out / "theirs.mcap"
    words = ["convert", short, "-o", ours, "-q", "--jobs", "2"]
    converted = Task(
        f"convert {short.name}, 2 at once",
        [
            Contender(f"{OURS} --jobs 2", tool(*words), ours),
            Contender(LIBRARIES, script("library_convert.py", short, theirs), theirs),
        ],
    )
    return [*start_tasks(logs, out), converted, stats_task(short)]


@dataclass(frozen=True)
class Ratio:
    """What a contender takes over what ours does, in one task or two."""

    name: str
    above: tuple[str, str]
    """Task and contender; also `below`."""
    below: tuple[str, str]
    least: float | None = None
    """The guard lets no less pass, of processor time; also `most`: coarse, half as good as now."""
    most: float | None = None

    @property
    def limit(self) -> str:
        """What the guard demands, in words."""
        least = [f"at least {self.least}"] if self.least else []
        return (
            ", ".join([*least, *([f"at most {self.most}"] if self.most else [])]) or "not guarded"
        )


def _of_convert(log: str, name: str = "", jobs: int = 2) -> tuple[str, str]:
    return f"convert {log}, {jobs} at once", name or f"{OURS} --jobs {jobs}"


def _start(command: str, name: str = OURS) -> tuple[str, str]:
    return f"start: {command} 1.bag", name


def _libraries(what: str, log: str, jobs: int = 2, least: float | None = None) -> Ratio:
    above, below = _of_convert(log, LIBRARIES), _of_convert(log, jobs=jobs)
    return Ratio(f"libraries / ours, {what}", above, below, least)


RATIOS: Final = (
    Ratio("ours / numpy, convert of 1 s", _start("convert"), _start("convert", NUMPY), most=6.0),
    Ratio("ours / numpy, stats of 1 s", _start("stats"), _start("stats", NUMPY), most=6.0),
    Ratio("libraries / ours, 1 s", _start("convert", LIBRARIES), _start("convert")),
    _libraries("1 min bag", "60.bag", least=4.0),
    _libraries("10 min bag", "600.bag"),
    Ratio(
        "libraries / ours, 10 min bag, one thread",
        _of_convert("600.bag", LIBRARIES),
        _of_convert("600.bag", jobs=1),
    ),
    _libraries("1 min MCAP", "60_ros1.mcap"),
    _libraries("10 min MCAP", "600_ros1.mcap"),
    _libraries("1 min of a hexapod at 1 kHz", HEXAPOD),
    Ratio(
        "rosbags / ours, stats of the 1 min bag",
        ("stats 60.bag", FORCES),
        ("stats 60.bag", OURS),
        least=1.5,
    ),
    Ratio(
        "rosbags / ours, stats of the 10 min bag",
        ("stats 600.bag", FORCES),
        ("stats 600.bag", OURS),
    ),
    Ratio(
        "loop / ours, convert of 100 logs of 1 s",
        (f"convert {FOLDER}", f"{LIBRARIES}, a loop"),
        (f"convert {FOLDER}", OURS),
    ),
    Ratio(
        "pymcap-cli / ours, 10 min bag",
        _of_convert("600.bag", "pymcap-cli bag2mcap (copies only)"),
        _of_convert("600.bag"),
    ),
    Ratio("ours / bound, 10 min bag", _of_convert("600.bag"), _of_convert("600.bag", BOUND)),
    Ratio("10 min / 1 min", _of_convert("600.bag"), _of_convert("60.bag")),
)


def ratios(times: Mapping[tuple[str, str], float]) -> Iterator[tuple[Ratio, float]]:
    """Yield the ratios of which both times are there.

    Args:
        times: s, by task and contender.
    """
    for each in RATIOS:
        if each.above in times and each.below in times:
            yield each, round(times[each.above] / times[each.below], 2)
