"""Changes the code at random and looks whether tests notice: ``python -m tests.mutants.sample``.

Each mutant is one small change that cosmic-ray makes (another operator, another number, a
condition turned round) in a copy of the checkout; then the tests of that room run. A mutant that
no test notices has survived. ``make mutants`` tries a sample of `core`.
"""

import argparse
import ast
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import chdir
from pathlib import Path
from typing import Final

from cosmic_ray.commands import execute, init
from cosmic_ray.config import ConfigDict
from cosmic_ray.modules import find_modules
from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import MutationSpec, WorkerOutcome, WorkItem, WorkResult

from tests.paths import ROOT

_NOT_COPIED: Final = shutil.ignore_patterns(
    ".*", "build", "*.egg-info", "__pycache__", "demo_output"
)
_PATIENCE_S: Final = 300.0
CAUGHT: Final = 0.9
"""Share of the mutants that tests must notice."""


def annotations(source: str) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Return where type annotations stand, which no test can notice: (line, column) from, to."""
    found = []
    for node in ast.walk(ast.parse(source)):
        for name in ("annotation", "returns"):
            part = getattr(node, name, None)
            if isinstance(part, ast.expr) and part.end_lineno is not None:
                end = (part.end_lineno, part.end_col_offset or 0)
                found.append(((part.lineno, part.col_offset), end))
    return found


def is_in_code(mutation: MutationSpec) -> bool:
    """Tell whether a mutation changes what runs."""
    spans = annotations(mutation.module_path.read_text(encoding="utf-8"))
    return not any(start <= mutation.start_pos < end for start, end in spans)


def choose(database: WorkDB, count: int, seed: int) -> list[WorkItem]:
    """Leave a random sample of the mutants to be tried; skip the others."""
    items = sorted(database.work_items, key=lambda item: _position(item.mutations[0]))
    items = [item for item in items if is_in_code(item.mutations[0])]
    chosen = random.Random(seed).sample(items, min(count, len(items)))  # noqa: S311
    kept = {item.job_id for item in chosen}
    skipped = [item.job_id for item in database.work_items if item.job_id not in kept]
    database.set_multiple_results(skipped, WorkResult(WorkerOutcome.SKIPPED))
    return chosen


def _position(mutation: MutationSpec) -> tuple[str, tuple[int, int], str, int]:
    path = str(mutation.module_path)
    return path, mutation.start_pos, mutation.operator_name, mutation.occurrence


def try_mutants(
    room: str, tests: Sequence[str], count: int, seed: int
) -> Iterator[tuple[MutationSpec, WorkResult]]:
    """Try a sample of the mutants of a room; yield each with what came of it.

    Args:
        room: folder of the package, such as ``core/gait``.
        tests: folders and files of tests.
        count: mutants to try.
        seed: what decides which.
    """
    with tempfile.TemporaryDirectory() as name:
        copy = Path(name) / "checkout"
        shutil.copytree(ROOT, copy, ignore=_NOT_COPIED)
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
        with chdir(copy):
            subprocess.run(command, check=True, capture_output=True)  # noqa: S603
            config = ConfigDict(
                {
                    "timeout": _PATIENCE_S,
                    "test-command": " ".join(command),
                    "distributor": {"name": "local"},
                }
            )
            with use_db(f"{name}/mutants.sqlite", WorkDB.Mode.create) as database:
                init(find_modules([Path("dogbot_logtool") / room]), database, {})
                chosen = {item.job_id: item.mutations[0] for item in choose(database, count, seed)}
                execute(database, config)
                results = dict(database.results)
        for job, mutation in chosen.items():
            yield mutation, results[job]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--room", default="core", help="folder of the package")
    parser.add_argument("--tests", nargs="*", default=["tests/core"], help="what should notice")
    parser.add_argument("--count", type=int, default=60, help="mutants to try")
    parser.add_argument("--seed", type=int, default=1, help="another sample")
    arguments = parser.parse_args()
    tried = caught = 0
    for mutation, result in try_mutants(
        arguments.room, arguments.tests, arguments.count, arguments.seed
    ):
        tried += 1
        caught += result.is_killed
        if not result.is_killed:
            where = f"{mutation.module_path}:{mutation.start_pos[0]}"
            print(f"survived: {where} {mutation.operator_name}\n{result.diff}", flush=True)  # noqa: T201
    print(f"{caught} of {tried} mutants were noticed (seed {arguments.seed})")  # noqa: T201
    sys.exit(caught < CAUGHT * tried)


if __name__ == "__main__":
    main()
