"""Compares two MCAPs with the mcap library, message by message, bytes only.

python benchmarks/library_compare.py EXPECTED.mcap ACTUAL.mcap
"""

import sys
from collections.abc import Iterator
from itertools import zip_longest
from pathlib import Path

from mcap.reader import make_reader

Read = tuple[str, str, int, bytes]
"""Topic, type, log time, payload."""


def messages(path: Path) -> Iterator[Read]:
    """Yield the messages in the order of their log times."""
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            yield channel.topic, schema.name if schema else "", message.log_time, message.data


def main(expected: Path, actual: Path) -> int:
    """Return the exit code: 1 when they differ."""
    pairs = zip_longest(messages(expected), messages(actual))
    return int(any(one != other for one, other in pairs))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
