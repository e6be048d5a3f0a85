"""Signatures of logs: a file's first bytes, or the name of a ROS 2 bag's metadata.

They stand apart from the code of the containers, which need not be loaded to recognise one.
"""

from typing import Final

BAG_MAGIC: Final = b"#ROSBAG V2.0\n"
MCAP_MAGIC: Final = b"\x89MCAP0\r\n"
SQLITE_MAGIC: Final = b"SQLite format 3\0"
ZSTD_MAGIC: Final = b"\x28\xb5\x2f\xfd"
"""Also before messages that a recorder compressed one by one: no CDR message begins like it."""
_ZSTD_SKIPPED: Final = b"\x2a\x4d\x18"
"""After a byte of 0x50 to 0x5f: a frame to be skipped, with which parallel compressors begin."""
ROSBAG2_METADATA: Final = "metadata.yaml"
ANNOTATED: Final = ".annotated.mcap"
"""Default ending of the files that `convert` writes: they are no part of a bag."""


def is_zstd(start: bytes) -> bool:
    """Tell whether bytes are the start of a file that was compressed with zstd."""
    is_skipped = b"\x50" <= start[:1] <= b"\x5f" and start[1:4] == _ZSTD_SKIPPED
    return is_skipped or start.startswith(ZSTD_MAGIC)
