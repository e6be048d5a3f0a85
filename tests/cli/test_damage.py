"""Damage is said first, and in the same words, by every command that reads a log."""

import json
import re
import shutil
from collections.abc import Iterator
from functools import cache
from html import unescape
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, Final
from xml.etree import ElementTree as ET

import pytest

from tests.forked_cli import Ended, run
from tests.oracles import walks

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


@cache
def made() -> Path:
    """A folder with a sound log, and the same in each container, cut off."""
    folder = Path(mkdtemp(prefix="dogbot-logtool-tests-"))
    walks.write_mcap(folder / "SOUND", walks.Walk(2), walks.messages(2, WRENCHES), 20_000)
    shutil.copy(folder / "SOUND", folder / "mcap")
    walks.write_walk(folder, WRENCHES, "bag").rename(folder / "bag")
    bag = walks.write_walk(folder, WRENCHES, "rosbag2-sqlite3").rename(folder / "directory")
    (rows,) = bag.glob("*.db3")
    for file in (folder / "bag", folder / "mcap", rows):
        data = file.read_bytes()
        file.write_bytes(data[: int(len(data) * SHARE)])
    shutil.copy(rows, folder / "db3")
    return folder


@pytest.fixture(params=["bag", "mcap", "db3", "directory"])
def folder(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A folder with LOG in a container, cut off, SOUND, and limits that LOG keeps or breaks."""
    source = made() / request.param
    copied = shutil.copytree if source.is_dir() else shutil.copy
    copied(source, tmp_path / "LOG")
    shutil.copy(made() / "SOUND", tmp_path)
    (tmp_path / "kept.toml").write_text(LIMITS.format(1.0))
    (tmp_path / "broken.toml").write_text(LIMITS.format(0.0))
    return tmp_path


def call(folder: Path, words: str) -> Ended:
    return run(*words.split(), folder=folder)


def texts(value: Any) -> Iterator[str]:
    """Every text in a JSON document."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for each in value.values() if isinstance(value, dict) else value:
            yield from texts(each)


def test_every_command_says_it_first(folder: Path) -> None:
    first, *others = call(folder, "info LOG").stderr.splitlines()
    assert not others
    damage = first.removeprefix("damage: LOG: ")
    for words, where in CALLS:
        ended = call(folder, words)
        assert ended.stderr.splitlines()[0] == first, words
        assert ended.returncode == (1 if any(each in words for each in FAULTS) else 3), words
        if where == "lines":
            lines = [line.lstrip("# ") for line in ended.stdout.splitlines()[:6]]
            assert damage in " ".join(lines), words
        elif where == "json":
            assert damage in texts(json.loads(ended.stdout)), words
        elif where:
            assert damage in unescape((folder / where).read_text()), words
    checked = ET.parse(folder / "check.xml")  # noqa: S314 - our own
    (case,) = checked.findall(".//testcase[@name='the log is not damaged']")
    assert damage in case.findtext("system-out", "")
    compared = ET.parse(folder / "compare.xml")  # noqa: S314 - our own
    (error,) = compared.findall(".//error")
    assert damage in error.attrib["message"]


def test_it_is_said_from_where_to_where(folder: Path) -> None:
    """The walk has as many bytes in each of its seconds, and what is cut off are the last ones."""
    file = next((folder / "LOG").glob("*.db3")) if (folder / "LOG").is_dir() else folder / "LOG"
    said = call(folder, "info LOG").stderr.split(": ")[2]
    size = file.stat().st_size
    (start,) = re.findall(r"from byte ([\d,]+) (?:on|to byte " + f"{size:,})", said)
    assert 0.9 * size < int(start.replace(",", "")) <= size
    (since_s,) = re.findall(r"from ([\d.]+) s on", said)
    duration_s = walks.SAMPLES * walks.STEP / 1e9
    assert float(since_s) == pytest.approx(SHARE * duration_s, abs=0.1 * duration_s)
