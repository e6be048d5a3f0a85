"""Files that are no logs: what their first bytes show them to be, and what to do about it."""

import re
from typing import Final

from dogbot_logtool.reader.containers.registry import (
    CONTAINERS,
    MCAP_MAGIC,
    ROSBAG2_METADATA,
    ZSTD_MAGIC,
)
from dogbot_logtool.reader.containers.source import ByteSource

_HEAD: Final = 4096
_SAMPLES: Final = 64
"""Blocks, spread over a file, that are read to see whether all of it is zero."""
_BYTE_ORDER_MARK: Final = b"\xef\xbb\xbf"
_BEFORE_POINTERS: Final = rb"\A(?:\xef\xbb\xbf)?(?:\.\./)*"
"""A byte-order mark, and the way up from a link that was written as a file."""
_TEXT_MODE: Final = (
    "was changed by a transfer in text mode: its line ends are no longer the recorded ones, and so "
    "are bytes everywhere in it; copy it again in binary mode"
)
_SAVED_AS_TEXT: Final = (
    "was saved as text on its way (by an editor, a script or a download that took it for text), so "
    "that bytes everywhere in it are no longer the recorded ones; copy it again in binary mode"
)
_CHANGED_LINE_ENDS: Final = (
    MCAP_MAGIC.replace(b"\r\n", b"\n"),
    MCAP_MAGIC.replace(b"\r\n", b"\r\x01"),
    *(each.magic.replace(b"\n", b"\r\n") for each in CONTAINERS if b"\n" in each.magic),
)
_RECODED: Final = (
    *(_BYTE_ORDER_MARK + each.magic for each in CONTAINERS),
    *(start + MCAP_MAGIC[1:] for start in (b"\xef\xbf\xbd", b"\xc2\x89", b"\xe2\x80\xb0", b"?")),
    MCAP_MAGIC[1:],
)
"""How a log begins with a byte-order mark before it; and an MCAP that was read as UTF-8, Latin-1,
Windows-1252 or ASCII and written again."""
_STARTS: Final = {
    **dict.fromkeys(_CHANGED_LINE_ENDS, _TEXT_MODE),
    **dict.fromkeys(_RECODED, _SAVED_AS_TEXT),
    b"version https://git-lfs.github.com/spec/": (
        "is a Git LFS pointer, not the log itself; 'git lfs pull' fetches the log"
    ),
    b"/annex/objects/": "is a git-annex pointer, not the log itself; 'git annex get' fetches it",
    b".git/annex/objects/": (
        "is a git-annex pointer, not the log itself; 'git annex get' fetches it"
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
    b"Salted__": "is encrypted (openssl enc); decrypt it first",
    b"age-encryption.org/": "is encrypted (age); decrypt it first",
    b"-----BEGIN PGP MESSAGE": "is encrypted (PGP); decrypt it first ('gpg -d')",
    b"PK\x03\x04": "is a zip archive; unpack it first ('unzip')",
    b"PK\x07\x08": "is a part of a split zip archive; join the parts and unpack it ('unzip')",
    b"PK\x05\x06": "is an empty zip archive",
    b"7z\xbc\xaf\x27\x1c": "is a 7z archive; unpack it first ('7z x')",
    b"Rar!\x1a\x07": "is a RAR archive; unpack it first ('unrar x')",
    b"\x37\x7f\x06\x82": "is the write-ahead log of a SQLite file; name the .db3 file beside it",
    b"\x37\x7f\x06\x83": "is the write-ahead log of a SQLite file; name the .db3 file beside it",
    b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7": (
        "is the journal of a SQLite file; name the .db3 file beside it"
    ),
    b"\0\x05\x16\x07": "holds what macOS knows of another file; name the file without the '._'",
    b"ULog\x01\x12\x35": "is a ULog of a PX4 flight controller, which this program does not read",
    b"\x89HDF\r\n\x1a\n": "is an HDF5 file, which this program does not read",
    b"PAR1": "is a Parquet file, not a log",
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
    if not head:
        return "is empty (0 bytes): nothing was recorded or copied into it"
    known = re.sub(_BEFORE_POINTERS, b"", head)
    for start, what in _STARTS.items():
        if head.startswith(start) or known.startswith(start):
            return what
    if head[257:262] == b"ustar":
        return "is a tar archive; unpack it first ('tar xf')"
    if not head.strip(b"\0"):
        return _describe_zeros(source)
    text = head.removeprefix(_BYTE_ORDER_MARK).lstrip()
    return _describe_text(text) or _unknown(source.size, head)


def _describe_zeros(source: ByteSource) -> str:
    step = max(source.size // _SAMPLES, _HEAD)
    sampled = (source.read(offset, _HEAD) for offset in range(0, source.size, step))
    if any(block.strip(b"\0") for block in sampled):
        return "begins with zeros where a log says what it is: its first part was never written"
    return (
        f"holds {source.size} bytes, all zero as far as was looked: room was made for it, but it "
        "was never written (a crash or a copy that broke off); copy it again"
    )


def _describe_text(text: bytes) -> str | None:
    """Say what a text is that a server may have sent in place of a log; None: it is none."""
    start = text[:256].lower()
    if start.startswith((b"<!doctype html", b"<html", b"<head", b"<body")):
        return (
            "is a web page, not a log: maybe that of a log-in or of an error; open the address in "
            "a browser, and download the file itself"
        )
    if start.startswith((b"<?xml", b"<error>")):
        return "is an XML text, not a log: maybe a server's error; look into it, download it again"
    if re.match(rb'\{\s*["}]|\[\s*["\[\]{\d.tfn-]', text):
        return (
            "is a JSON text, not a log: maybe a server's error (look into it, and download the log "
            "again), or metrics of 'stats --json', which only 'compare' reads"
        )
    return None


def _unknown(size: int, head: bytes) -> str:
    for container in CONTAINERS:
        if container.magic.startswith(head):
            return f"breaks off after {size} bytes, before a log says what it is; copy it again"
    return (
        "is neither a ROS 1 bag (#ROSBAG V2.0) nor an MCAP file nor a file of a ROS 2 bag: "
        "its first bytes are none of theirs"
    )
