"""Runs every command on real logs and on damaged ones: ``python -m tests.torture.commands``.

What is looked at are the promises of the program: an exit code of 0 to 3, no traceback, JSON that
parses, an end in time, and nothing left in the folder but outputs that were asked for.
Real logs are those below LOGTOOL_CORPUS, if that is set; ``--damaged N`` adds N copies of sample
logs, damaged at random.
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from tests.forked_cli import Ended, run
from tests.paths import TROUBLED, WALK
from tests.reader.mutation import CASES, random_mutation

SAMPLES: Final = (TROUBLED, WALK)
COMMANDS: Final = (
    "info {log}",
    "info {log} --json --frames",
    "convert {log} -o out.mcap",
    "convert {log} -o own.mcap --no-copy --encoding ros1 --style force",
    "convert {log} -o own.mcap --encoding ros2 --style classic --jobs 1 --compression lz4",
    "convert {log} -o own.mcap --tf-rate 0",
    "stats {log}",
    "stats {log} --json",
    "export {log} --start 0.1",
    "export {log} --dataset figures",
    "export {log} --table events -o events.csv",
    "check --suggest {log}",
    "robots new {log} -o robot.toml",
    "report {log} -o page.html",
    "layout {log} -o view.json",
    "compare {log} {log}",
    "compare --gait {log} {log}",
)
OUTPUTS: Final = {
    "out.mcap",
    "own.mcap",
    "page.html",
    "view.json",
    "figures",
    "events.csv",
    "robot.toml",
}
SUFFIXES: Final = (".bag", ".mcap", ".db3", ".active", ".zstd")
PATIENCE_S: Final = 120.0


@dataclass(frozen=True, slots=True)
class Attempt:
    """How a command ended."""

    exit_code: int
    seconds: float
    faults: tuple[str, ...]


def attempt(command: str, log: Path) -> Attempt:
    """Run a command on a log, in a folder of its own."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        words = [word.format(log=log) for word in command.split()]
        begin = time.monotonic()
        try:
            ended = run(*words, folder=folder, timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            return Attempt(-signal.SIGKILL, PATIENCE_S, ("does not end",))
        seconds = time.monotonic() - begin
        return Attempt(ended.returncode, seconds, tuple(faults_of(ended, words, folder)))


def faults_of(ended: Ended, words: Sequence[str], folder: Path) -> Iterator[str]:
    """Yield what is wrong with how a command ended."""
    code, out, err = ended.returncode, ended.stdout, ended.stderr
    if not 0 <= code <= 3:
        yield f"exit code {code}: {err[-2000:]}"
    if "Traceback" in out + err or "Exception ignored" in err:
        yield f"traceback: {err[-2000:]}"
    if code == 3 and not err.startswith("damage: "):
        yield f"damage is not said first: {err[-2000:]}"
    if code in {1, 2} and not (out or err):
        yield f"exit code {code} without a word"
    if "--json" in words and out:
        try:
            json.loads(out, parse_constant=_refuse)
        except ValueError as error:
            yield f"JSON: {error}"
    left = {path.name for path in folder.iterdir()} - OUTPUTS
    if left:
        yield f"left behind: {', '.join(sorted(left))}"
    if code in {1, 2} and words[0] == "convert" and list(folder.glob("*.mcap")):
        yield "failed, and left an output"


def _refuse(constant: str) -> float:
    raise ValueError(f"{constant} is no JSON")


def real_logs() -> list[Path]:
    """Return the logs below LOGTOOL_CORPUS; a ROS 2 bag's directory is one, as are its files."""
    corpus = os.environ.get("LOGTOOL_CORPUS")
    if not corpus:
        return []
    found = sorted(Path(corpus).rglob("*"))
    files = [path for path in found if path.suffix in SUFFIXES and path.is_file()]
    return files + [path.parent for path in found if path.name == "metadata.yaml"]


def damaged_logs(folder: Path, count: int, seed: int) -> Iterator[Path]:
    """Yield damaged logs one by one; each takes the place of the one before."""
    chance = random.Random(seed)  # noqa: S311 - not for secrets
    sources = [path.read_bytes() for path in SAMPLES] + [case.data for case in CASES]
    suffixes = [path.suffix for path in SAMPLES] + [".log"] * len(CASES)
    for number in range(count):
        choice = chance.randrange(len(SAMPLES)) if number % 2 else chance.randrange(len(sources))
        data = sources[choice]
        for _ in range(chance.choice([1, 1, 2, 5])):
            data = random_mutation(chance, len(data)).apply(data)
        path = folder / f"damaged_{number}{suffixes[choice]}"
        path.write_bytes(data)
        yield path
        path.unlink()


def torture(
    logs: Iterator[Path], commands: Sequence[str] = COMMANDS
) -> Iterator[tuple[str, Path, Attempt]]:
    """Run commands on logs; yield how each ended."""
    for log in logs:
        for command in commands:
            yield command, log, attempt(command, log)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--damaged", type=int, default=200, help="logs damaged at random")
    parser.add_argument("--seed", type=int, help="repeat a run")
    parser.add_argument("--every", type=int, default=1, help="take every Nth real log")
    parser.add_argument("--only", default="", help="commands that contain this text")
    arguments = parser.parse_args()
    seed = arguments.seed
    if seed is None:
        seed = random.SystemRandom().randrange(1 << 32)
    commands = [command for command in COMMANDS if arguments.only in command]
    codes: dict[str, Counter[int]] = {command: Counter() for command in commands}
    faults, slowest = 0, (0.0, "")
    with tempfile.TemporaryDirectory() as name:
        real = iter(real_logs()[:: arguments.every])
        for logs in (real, damaged_logs(Path(name), arguments.damaged, seed)):
            for command, log, ended in torture(logs, commands):
                codes[command][ended.exit_code] += 1
                slowest = max(slowest, (ended.seconds, command.format(log=log.name)))
                for fault in ended.faults:
                    print(f"{command.format(log=log)}: {fault}", flush=True)  # noqa: T201
                    faults += 1
    print(f"seed {seed}; the slowest, {slowest[0]:.1f} s: {slowest[1]}")  # noqa: T201
    for command, counter in codes.items():
        ends = ", ".join(f"{count} x {code}" for code, count in sorted(counter.items()))
        print(f"{command:90} {ends}")  # noqa: T201
    print(f"{faults} faults")  # noqa: T201
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
