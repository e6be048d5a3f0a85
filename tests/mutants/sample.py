"""Changes the code at random and looks whether tests notice: ``python -m tests.mutants.sample``.

Each mutant is one small change that cosmic-ray makes (another operator, another number, a
condition turned round) in a copy of the checkout. The tests of the changed file's own folder run
first, and where these do not notice the goldens, and those of the core, of known truth, and of
commands. A mutant that no test notices has survived. ``make mutants`` tries a sample of `core`.
"""

import argparse
import ast
import random
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import chdir
from functools import cache
from pathlib import Path
from typing import Final

from cosmic_ray.commands import init
from cosmic_ray.modules import find_modules
from cosmic_ray.mutating import mutate_and_test
from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import MutationSpec, WorkItem, WorkResult

from tests.paths import ROOT

_NOT_COPIED: Final = shutil.ignore_patterns(
    ".*", "build", "*.egg-info", "__pycache__", "demo_output"
)
_PATIENCE_S: Final = 600.0
NOTICING: Final = ("tests/sample_logs", "tests/core", "tests/truth", "tests/commands")
CAUGHT: Final = 0.9
"""Share of the mutants that tests must notice."""


@cache
def unnoticeable(module: Path) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Return what no test of behaviour can notice: (line, column) from, to.

    These are type annotations, and whether records are frozen.
    """
    found = []
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        parts = [getattr(node, name, None) for name in ("annotation", "returns")]
        for part in (*parts, *getattr(node, "decorator_list", ())):
            if isinstance(part, ast.expr) and part.end_lineno is not None:
                end = (part.end_lineno, part.end_col_offset or 0)
                found.append(((part.lineno, part.col_offset), end))
    return found


def is_in_code(mutation: MutationSpec) -> bool:
    """Tell whether a mutation changes what runs."""
    spans = unnoticeable(mutation.module_path)
    return not any(start <= mutation.start_pos < end for start, end in spans)


def choose(database: WorkDB, count: int, seed: int) -> list[WorkItem]:
    """Return a random sample of the mutants."""
    items = sorted(database.work_items, key=lambda item: _position(item.mutations[0]))
    items = [item for item in items if is_in_code(item.mutations[0])]
    return random.Random(seed).sample(items, min(count, len(items)))  # noqa: S311


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
        with chdir(copy):
            subprocess.run(command(tests), check=True, capture_output=True)  # noqa: S603
            with use_db(f"{name}/mutants.sqlite", WorkDB.Mode.create) as database:
                init(find_modules([Path("dogbot_logtool") / room]), database, {})
                chosen = choose(database, count, seed)
            for item in chosen:
                own = own_tests(item.mutations[0].module_path)
                result = mutated(item, own) if own else None
                if result is None or not result.is_killed:
                    result = mutated(item, tests)
                yield item.mutations[0], result


def mutated(item: WorkItem, tests: Sequence[str]) -> WorkResult:
    """Run tests of a mutant."""
    return mutate_and_test(item.mutations, shlex.join(command(tests)), _PATIENCE_S)


def own_tests(module: Path) -> list[str]:
    """Return the tests beside those that mirror a module of the package."""
    folder = Path("tests") / module.parent.relative_to("dogbot_logtool")
    return sorted(map(str, folder.glob("test_*.py")))


def command(tests: Sequence[str]) -> list[str]:
    """Return the call that runs tests until the first one fails."""
    words = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    return [*words, "-m", "not slow", *tests]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--room", default="core", help="folder of the package")
    parser.add_argument("--tests", nargs="*", default=NOTICING, help="what should notice")
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
