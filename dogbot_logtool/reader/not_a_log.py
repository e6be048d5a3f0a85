"""Files that are no logs: what their first bytes show them to be, and what to do about it."""

from typing import Final

from dogbot_logtool.reader.containers.registry import CONTAINERS, ROSBAG2_METADATA, ZSTD_MAGIC
from dogbot_logtool.reader.containers.source import ByteSource

_HEAD: Final = 4096
_BYTE_ORDER_MARK: Final = b"\xef\xbb\xbf"
_TAKEN_FOR_TEXT: Final = (
    # Other line ends.
    b"\x89MCAP0\n",
    b"\x89MCAP0\r\r\n",
    b"\x89MCAP0\r\x01",
    b"#ROSBAG V2.0\r\n",
    # Read as UTF-8, Latin-1, Windows-1252 or ASCII, and written again.
    *(start + b"MCAP" for start in (b"", b"\xef\xbf\xbd", b"\xc2\x89", b"\xe2\x80\xb0", b"?")),
    *(_BYTE_ORDER_MARK + each.magic for each in CONTAINERS),
)
_ZEROS: Final = (
    "begins with zeros where a log says what it is: room was made for it, but its start was never "
    "written (a crash or a copy that broke off); copy it again"
)
_ANNEX: Final = "is a git-annex pointer, not the log itself; 'git annex get' fetches it"
_TEXT: Final = (
    "is a text (a web page, XML or JSON), not a log: maybe a server's error in place of it; look "
    "into it, and download the log again"
)
_UNKNOWN: Final = (
    "is neither a ROS 1 bag (#ROSBAG V2.0) nor an MCAP file nor a file of a ROS 2 bag: its first "
    "bytes are none of theirs"
)
_STARTS: Final = {
    **dict.fromkeys(
        _TAKEN_FOR_TEXT,
        "was changed on its way by what took it for text (a transfer, an editor, a script): bytes "
        "everywhere in it are no longer the recorded ones; copy it again in binary mode",
    ),
    b"version https://git-lfs.": (
        "is a Git LFS pointer, not the log itself; 'git lfs pull' fetches the log"
    ),
    b"outs:\n- md5:": "is a DVC pointer, not the log itself; 'dvc pull' fetches the log",
    b"#ROSBAG V1": (
        "is a bag of an older format than 2.0; 'rosbag fix' or 'rosbag migrate' updates it"
    ),
    b"\x1f\x8b": "is a gzip-compressed file; decompress it first ('gunzip')",
    b"BZh": "is a bzip2-compressed file; decompress it first ('bunzip2')",
    b"\xfd7zXZ\0": "is an xz-compressed file; decompress it first ('unxz')",
    b"\x04\x22\x4d\x18": "is an lz4-compressed file; decompress it first ('unlz4')",
    ZSTD_MAGIC: "was compressed with zstd twice; decompress it once ('unzstd')",
    b"PK": "is a zip archive; unpack it first ('unzip')",
    b"7z\xbc\xaf\x27\x1c": "is a 7z archive; unpack it first ('7z x')",
    b"rosbag2_bagfile_information:": (
        f"is the {ROSBAG2_METADATA} of a ROS 2 bag; name the directory that it is in"
    ),
}


def is_known(magic: bytes) -> bool:
    """Tell whether a file is of a known kind that is not read, though it may resemble a log.

    A log that was taken for text on its way is one: lengths and offsets no longer hold in it.
    """
    return magic.startswith(tuple(_STARTS))


def describe(source: ByteSource) -> str:
    """Return the sentence, without its subject, that says what a file is if not a log."""
    head = source.read(0, _HEAD)
    is_cut_off = any(each.magic.startswith(head) for each in CONTAINERS)
    text = head.removeprefix(_BYTE_ORDER_MARK).lstrip()
    cases = (
        (not head, "is empty (0 bytes): nothing was recorded or copied into it"),
        *((head.startswith(start), what) for start, what in _STARTS.items()),
        (head[257:262] == b"ustar", "is a tar archive; unpack it first ('tar xf')"),
        (not head.strip(b"\0"), _ZEROS),
        (b"annex/objects/" in head[:64], _ANNEX),
        (text.startswith((b"<", b"{", b"[")), _TEXT),
        (
            is_cut_off,
            f"breaks off after {source.size} bytes, before a log says what it is; copy it again",
        ),
        (True, _UNKNOWN),
    )
    return next(what for fits, what in cases if fits)
