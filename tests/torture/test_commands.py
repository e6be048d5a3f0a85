"""Commands on damaged logs: a few, and by the hundred in `make torture`.

Their promises are an exit code of 0 to 3, no traceback, JSON that parses, an end in time, and
nothing left in the folder but outputs that were asked for.
"""

import itertools
import json
import os
import random
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import pytest

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
TRIES, SEED = (int(os.environ.get(name, "1")) for name in ("TRIES", "SEED"))
SUFFIXES: Final = (".bag", ".mcap", ".db3", ".active", ".zstd")
PATIENCE_S: Final = 120.0


def attempt(command: str, log: Path) -> tuple[int, list[str]]:
    """Run a command on a log, in a folder of its own; return its exit code and what is wrong."""
    with tempfile.TemporaryDirectory() as name:
        words = [word.format(log=log) for word in command.split()]
        try:
            ended = run(*words, folder=Path(name), timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            return -1, ["does not end"]
        return ended.returncode, list(faults_of(ended, words, Path(name)))


def faults_of(ended: Ended, words: Sequence[str], folder: Path) -> Iterator[str]:
    """Yield what is wrong with how a command ended."""
    code, out, err = ended.returncode, ended.stdout, ended.stderr
    if not 0 <= code <= 3:
        yield f"exit code {code}: {err[-2000:]}"
    if "Exception ignored" in err:
        yield err[-2000:]
    if code == 3 and not err.startswith("damage: "):
        yield f"damage is not said first: {err[-2000:]}"
    if code in {1, 2} and not (out or err):
        yield f"exit code {code} without a word"
    if "--json" in words and out:
        try:
            json.loads(out, parse_constant=_refuse)
        except ValueError as error:
            yield f"JSON: {error}"
    outputs = {name for option, name in itertools.pairwise(words) if option in {"-o", "--dataset"}}
    left = {path.name for path in folder.iterdir()} - outputs
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


@pytest.mark.slow
def test_every_command_ends_well_on_damaged_logs(tmp_path: Path) -> None:
    real = real_logs() if TRIES > 1 else []
    damaged = damaged_logs(tmp_path, 2 * TRIES, SEED)
    codes = set()
    for log in itertools.chain(SAMPLES[:1], real, damaged):
        for command in COMMANDS:
            code, faults = attempt(command, log)
            assert faults == [], command.format(log=log)
            codes.add(code)
    assert codes >= {0, 3}
