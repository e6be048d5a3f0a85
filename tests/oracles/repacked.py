"""The messages of a ROS 1 bag, to be written anew: in any container, in any order."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Final

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from tests.oracles.mcap_file import Entry
from tests.oracles.recorded import read_log
from tests.oracles.walks import Walk

BLOCK: Final = 97
"""Messages that change places with as many others where a file is out of order."""


@cache
def unpacked(bag: Path, ros: int) -> tuple[Walk, list[Entry]]:
    """Return the messages as those of a version of ROS, and what has their types."""
    walk, entries = Walk(ros), []
    walk.store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
    known: set[str] = set()
    for each in read_log(bag):
        if each.type_name not in known:
            known.add(each.type_name)
            types = get_types_from_msg(each.definition, each.type_name)
            walk.store.register({k: v for k, v in types.items() if k not in walk.store.fielddefs})
        data = each.data if ros == 1 else walk.store.ros1_to_cdr(each.data, each.type_name)
        entries.append(Entry(each.topic, each.type_name, each.log_time, bytes(data)))
    return walk, entries


def out_of_order(entries: Sequence[Entry]) -> list[Entry]:
    """Return the same messages as a recorder of several threads may write them."""
    blocks = [entries[first : first + BLOCK] for first in range(0, len(entries), BLOCK)]
    for first in range(0, len(blocks) - 1, 2):
        blocks[first : first + 2] = blocks[first + 1], blocks[first]
    return [entry for block in blocks for entry in block]
