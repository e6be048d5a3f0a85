"""Damage is said first, and in the same words, by every command that reads a log."""

import re
import shutil
from collections.abc import Iterator, Sequence
from functools import cache
from html import unescape
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final
from xml.etree import ElementTree as ET

import pytest

from tests.oracles import walks
from tests.shell import Shell

WRENCHES: Final = "geometry_msgs/msg/WrenchStamped"
SHARE: Final = 0.6
"""Of each file that is left."""
LIMITS: Final = '[[rule]]\nfigure = "feet.*.contact_fraction"\nat_most = {}\n'
CALLS: Final = (
    # The call, and where the damage stands beside stderr: the first lines, JSON, or a file.
    ("info LOG", "lines"),
    ("info LOG --json -q", "json"),
    ("convert LOG -o out.mcap", ""),
    ("convert LOG -o out.mcap --overwrite --json -q", "json"),
    ("stats LOG", "lines"),
    ("stats LOG SOUND -q", "lines"),
    ("stats LOG --json -q", "json"),
    ("report LOG -o out.html", "out.html"),
    ("report LOG -o out.html --overwrite --json -q", "json"),
    ("report LOG --against SOUND -o out.html --overwrite -q", "out.html"),
    ("check LOG --limits kept.toml --junit check.xml", "lines"),
    ("check LOG --limits kept.toml --json -q", "json"),
    ("check LOG --limits broken.toml -q", "lines"),
    ("check LOG --suggest", "lines"),
    ("export LOG -q", ""),
    ("compare LOG LOG --junit compare.xml", "lines"),
    ("compare LOG LOG --json -q", "json"),
    ("compare SOUND LOG -q", ""),
    ("compare --gait LOG SOUND", "lines"),
    ("compare --gait LOG SOUND --json -q", "json"),
    ("layout LOG -q", ""),
    ("robots new LOG", "lines"),
)
FAULTS: Final = ("broken.toml", "compare SOUND", "compare --gait")
"""Calls that find a fault, too: of these two sides one has too few strides."""


_FOLDER: Final = TemporaryDirectory(prefix="damaged")


@cache
def made() -> Path:
    """A folder with a sound log, and the same in each container, cut off."""
    folder = Path(_FOLDER.name)
    walks.write_mcap(folder / "SOUND", walks.Walk(2), walks.messages(2, WRENCHES), 30_000)
    shutil.copy(folder / "SOUND", folder / "mcap")
    walks.write_walk(folder, WRENCHES, "bag").rename(folder / "bag")
    bag = walks.write_walk(folder, WRENCHES, "rosbag2-sqlite3").rename(folder / "directory")
    (rows,) = bag.glob("*.db3")
    for file in (folder / "bag", folder / "mcap", rows):
        data = file.read_bytes()
        file.write_bytes(data[: int(len(data) * SHARE)])
    shutil.copy(rows, folder / "db3")
    return folder


def prepare(folder: Path, container: str) -> None:
    """Put into a folder LOG, cut off, SOUND, and limits that LOG keeps or breaks."""
    source = made() / container
    copied = shutil.copytree if source.is_dir() else shutil.copy
    copied(source, folder / "LOG")
    shutil.copy(made() / "SOUND", folder)
    (folder / "kept.toml").write_text(LIMITS.format(1.0))
    (folder / "broken.toml").write_text(LIMITS.format(0.0))


def texts(value: Any) -> Iterator[str]:
    """Every text in a JSON document."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for each in value.values() if isinstance(value, dict) else value:
            yield from texts(each)


@pytest.mark.parametrize(
    ("container", "calls"),
    [("bag", CALLS), ("mcap", CALLS[::3]), ("db3", CALLS[1::3]), ("directory", CALLS[2::3])],
)
def test_every_command_says_it_first(
    shell: Shell, container: str, calls: Sequence[tuple[str, str]]
) -> None:
    prepare(shell.folder, container)
    first, *others = shell("info", "LOG").err.splitlines()
    assert not others
    damage = first.removeprefix("damage: LOG: ")
    for words, where in calls:
        done = shell(*words.split())
        assert done.err.splitlines()[0] == first, words
        assert done.code == (1 if any(each in words for each in FAULTS) else 3), words
        if where == "lines":
            lines = [line.lstrip("# ") for line in done.out.splitlines()[:6]]
            assert damage in " ".join(lines), words
        elif where == "json":
            assert damage in texts(done.json), words
        elif where:
            assert damage in unescape((shell.folder / where).read_text()), words
    for file, message in (("check.xml", ".//system-out"), ("compare.xml", ".//error")):
        if (shell.folder / file).exists():
            found = ET.parse(shell.folder / file).findall(message)  # noqa: S314 - our own
            assert any(damage in f"{each.text} {each.attrib}" for each in found), file


@pytest.mark.parametrize("container", ["bag", "mcap", "db3", "directory"])
def test_it_is_said_from_where_to_where(shell: Shell, container: str) -> None:
    """The walk has as many bytes in each of its seconds, and what is cut off are the last ones."""
    prepare(shell.folder, container)
    log = shell.folder / "LOG"
    said = shell("info", "LOG").err.split(": ")[2]
    size = (next(log.glob("*.db3")) if log.is_dir() else log).stat().st_size
    (start,) = re.findall(r"from byte ([\d,]+) (?:on|to byte " + f"{size:,})", said)
    assert 0.9 * size < int(start.replace(",", "")) <= size
    (since_s,) = re.findall(r"from ([\d.]+) s on", said)
    duration_s = walks.SAMPLES * walks.STEP / 1e9
    assert float(since_s) == pytest.approx(SHARE * duration_s, abs=0.1 * duration_s)
