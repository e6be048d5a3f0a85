"""MCAP as it is read and written: the layout of records, and how a file tells what was added to it.

`convert` adds a metadata record, and a mark on each of its channels.
"""

import struct
from collections.abc import Mapping
from typing import Final

import numpy as np

RECORD_HEAD: Final = struct.Struct("<BQ")
"""Opcode and length of the content, before every record."""
MESSAGE_HEAD: Final = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<i8"),
        ("publish_time", "<i8"),
    ]
)
"""A message record up to its payload."""
INDEX_HEAD: Final = struct.Struct("<BQHI")
"""A message index record up to its entries: opcode, length, channel, bytes of the entries."""
INDEX_ENTRY: Final = np.dtype([("log_time", "<i8"), ("offset", "<u8")])
PROVENANCE: Final = "dogbot_logtool"
"""Name of the metadata record that tells how the file was made."""
ANNOTATION_MARK: Final = {"dogbot_logtool": "annotation"}
"""Metadata of the channels that were added. Other tools renumber channels, but keep this."""


def is_marked(metadata: Mapping[str, str]) -> bool:
    """Tell whether a channel with such metadata is an annotation."""
    return ANNOTATION_MARK.items() <= metadata.items()
