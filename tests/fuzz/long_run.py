"""Harms small logs at random for a given time: ``python -m tests.fuzz.long_run --seconds 600``.

Each round has a seed of its own, which is printed when the round fails; ``--seed N`` repeats it.
"""

import argparse
import random
import sys
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path

from tests.reader.mutation import CASES, random_mutation, read_harmed

_SLOW_SECONDS = 5.0


def run_one(folder: Path, seed: int) -> str:
    """Harm one log; return what became of it."""
    chance = random.Random(seed)  # noqa: S311 - not for secrets
    case = chance.choice(CASES)
    mutations = [random_mutation(chance) for _ in range(chance.choice([1, 1, 1, 2, 3, 6]))]
    begin = time.monotonic()
    try:
        reading = read_harmed(folder, case, mutations)
    except Exception:  # noqa: BLE001 - whatever it is, it is a finding
        traceback.print_exc()
        print(f"seed {seed}: {case.name}: {mutations}")  # noqa: T201
        return "FAILED"
    if time.monotonic() - begin > _SLOW_SECONDS:
        print(f"seed {seed}: {case.name}: slow: {mutations}")  # noqa: T201
        return "SLOW"
    if reading is None:
        return "refused"
    if len(reading.messages) == len(case.log.written):
        return "all messages"
    return "some messages" if reading.messages else "no messages"


def main() -> int:
    """Run until the time is over; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, help="repeat one round")
    arguments = parser.parse_args()
    results: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if arguments.seed is not None:
            results[run_one(folder, arguments.seed)] += 1
        else:
            first = random.SystemRandom().randrange(1 << 40)
            print(f"first seed {first}")  # noqa: T201
            end = time.monotonic() + arguments.seconds
            while time.monotonic() < end:
                results[run_one(folder, first + results.total())] += 1
    print(f"{results.total()} logs: {dict(results)}")  # noqa: T201
    return 1 if results["FAILED"] or results["SLOW"] else 0


if __name__ == "__main__":
    sys.exit(main())
