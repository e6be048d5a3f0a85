"""How MCAP lays records out, as they are read and written by the column."""

import struct
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
