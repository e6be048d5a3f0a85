"""`metadata.yaml` of ROS 2 bags: what it orders and counts, and when it cannot be used."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import zstandard
from rosbags.rosbag2.enums import StoragePlugin

from tests.paths import ROOT
from tests.reader.containers.rosbag2.bags import ENTRIES, PLUGINS, database, expected, split, write
from tests.reader.mcap_bytes import small_mcap
from tests.reader.reading import read_file


def test_metadata_names_the_files_and_a_missing_one_is_a_loss(tmp_path: Path) -> None:
    whole = split(tmp_path, StoragePlugin.SQLITE3)
    names = ["walk_1.db3", "elsewhere/walk_0.db3", "../walk_99.db3"]
    text = "rosbag2_bagfile_information:\n  relative_file_paths:\n"
    (whole / "metadata.yaml").write_text(text + "".join(f"    - {name}\n" for name in names))
    for number in range(2, 11):
        (whole / f"walk_{number}.db3").unlink()
    reading = read_file(whole)
    assert list(reading.messages) == expected(ENTRIES[:80])
    assert reading.sentences == "metadata.yaml names walk_99.db3, which is not there"
    assert reading.lost is None


def test_files_that_metadata_does_not_name_are_said(tmp_path: Path) -> None:
    bag = write(tmp_path / "bag")
    data = database(bag).read_bytes()
    (bag / "other_0.db3").write_bytes(data)
    (bag / "other_1.db3.zstd").write_bytes(data)
    # Made by this program, and the same file in another form: neither is missing from the log.
    (bag / "walk.annotated.mcap").write_bytes(small_mcap().build())
    (bag / "bag.db3.zstd").write_bytes(zstandard.compress(data))
    reading = read_file(bag)
    assert list(reading.messages) == expected()
    assert sorted(loss.what for loss in reading.losses) == [
        "metadata.yaml does not name other_0.db3, so it was left out",
        "metadata.yaml does not name other_1.db3.zstd, so it was left out",
    ]
    assert reading.lost is None


def metadata_of(bag: Path, *changes: tuple[str, str]) -> None:
    text = (bag / "metadata.yaml").read_text()
    for pattern, replacement in changes:
        text, count = re.subn(pattern, replacement, text)
        assert count
    (bag / "metadata.yaml").write_text(text)


@pytest.mark.parametrize("plugin", PLUGINS)
@pytest.mark.parametrize(("promised", "lost"), [(5000, 4600), (300, 0)])
def test_metadata_that_counts_other_messages_is_said(
    tmp_path: Path, plugin: StoragePlugin, promised: int, lost: int
) -> None:
    bag = write(tmp_path / "bag", plugin)
    metadata_of(bag, (r"message_count: 400", f"message_count: {promised}"))
    reading = read_file(bag)
    assert list(reading.messages) == expected()
    assert reading.sentences == f"metadata.yaml counts {promised} messages, but 400 were found"
    assert reading.lost == lost


def test_files_that_were_renamed_are_read(tmp_path: Path) -> None:
    bag = write(tmp_path / "bag")
    database(bag).rename(bag / "renamed.db3")
    reading = read_file(bag)
    assert list(reading.messages) == expected()
    assert reading.sentences == (
        "metadata.yaml cannot be used (it names none of the files that are there); the files were "
        "taken by their names"
    )


def test_messages_of_a_missing_file_are_counted_once(tmp_path: Path) -> None:
    bag = write(tmp_path / "bag")
    (name,) = [file.name for file in bag.glob("*.db3")]
    files = f"relative_file_paths:\n    - gone.db3\n    - {name}\n  files:\n"
    files += "    - path: gone.db3\n      message_count: 70\n  others:"
    metadata_of(
        bag, ("relative_file_paths:", files), ("  message_count: 400", "  message_count: 470")
    )
    reading = read_file(bag)
    assert reading.sentences == (
        "metadata.yaml names gone.db3, which is not there; "
        "metadata.yaml counts 470 messages, but 400 were found"
    )
    assert reading.lost == 70


BOMB = "".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}' if n else 'x'] * 10)}]\n" for n in range(9))


HOSTILE = (
    (BOMB + "rosbag2_bagfile_information: {relative_file_paths: *a8}", "aliases"),
    ("[" * 400_000, "too deeply nested"),
    ("- " * 200_000, "too deeply nested"),
    ("{a: " * 100_000, "too deeply nested"),
    ("[" + "1," * 200_000 + "1]", "too long"),
    ("a" * 600_000, "larger than 512 kB"),
    ("!" + "a" * 300_000 + " b", "does not name"),
    ("rosbag2_bagfile_information: {relative_file_paths: 2001-01-01}", "does not name"),
    ("--- {}\n" * 60_000, "does not name"),
)
"""Metadata, and why it cannot be used."""


def test_hostile_metadata_is_left_unused_at_once(tmp_path: Path) -> None:
    """In an interpreter of its own, which it might end."""
    bags = [write(tmp_path / f"bag{number}") for number in range(len(HOSTILE))]
    for bag, (content, _) in zip(bags, HOSTILE, strict=True):
        (bag / "metadata.yaml").write_text(content)
    code = "import sys; from pathlib import Path; from tests.reader.reading import read_file\n"
    code += "for name in sys.argv[1:]: print(read_file(Path(name)).sentences)"
    done = subprocess.run(  # noqa: S603 - our own interpreter
        [sys.executable, "-c", code, *map(str, bags)],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
        cwd=ROOT,
    )
    sentences = done.stdout.split("metadata.yaml cannot be used (")
    assert sentences[0] == ""
    for sentence, (_, reason) in zip(sentences[1:], HOSTILE, strict=True):
        assert reason in sentence


def test_numbers_that_no_machine_has_are_no_counts(tmp_path: Path) -> None:
    bag = write(tmp_path / "bag")
    metadata_of(bag, ("message_count: 400", "message_count: " + "9" * 5000))
    assert read_file(bag).losses == ()


@pytest.mark.parametrize(
    "text", ["", "[", "a: &a [*a, *a]", "rosbag2_bagfile_information: 3", "\0"]
)
def test_bad_metadata_is_said(tmp_path: Path, text: str) -> None:
    bag = write(tmp_path / "bag")
    (bag / "metadata.yaml").write_text(text)
    reading = read_file(bag)
    assert list(reading.messages) == expected()
    assert "metadata.yaml" in reading.sentences
