"""ROS 2 bags of one walk, written by rosbags."""

import shutil
import sqlite3
from itertools import islice
from pathlib import Path

from rosbags.rosbag2 import Writer as Rosbag2Writer
from rosbags.rosbag2.enums import CompressionFormat, CompressionMode, StoragePlugin

from tests.oracles.walks import Entry, Walk, write_rows
from tests.reader.reading import Read

PLUGINS = tuple(StoragePlugin)
MODES = (CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE)
KIND = "gazebo_msgs/msg/ContactsState"
WALK = Walk(2)
ENTRIES = list(islice(WALK.messages(KIND), 400))


def write(
    path: Path,
    plugin: StoragePlugin = StoragePlugin.SQLITE3,
    mode: CompressionMode = CompressionMode.NONE,
    entries: list[Entry] = ENTRIES,
) -> Path:
    writer = Rosbag2Writer(path, version=9, storage_plugin=plugin)
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        rows = [(entry.log_time, entry.topic, entry.kind, entry.data) for entry in entries]
        write_rows(writer, WALK.store, rows)
    return path


def expected(entries: list[Entry] = ENTRIES) -> list[Read]:
    return [Read(entry.topic, entry.log_time, entry.data) for entry in entries]


def database(path: Path) -> Path:
    (file,) = path.glob("*.db3")
    return file


def change(path: Path, *statements: str) -> None:
    connection = sqlite3.connect(path)
    with connection:
        for statement in statements:
            connection.execute(statement)
    connection.close()


def split(folder: Path, plugin: StoragePlugin) -> Path:
    """Make eleven files without metadata, whose names sort otherwise than their numbers."""
    whole = folder / "whole"
    whole.mkdir()
    for number in range(11):
        run = ENTRIES[number * 40 : (number + 1) * 40]
        part = write(folder / f"part{number}", plugin, entries=run)
        (file,) = [file for file in part.iterdir() if file.name != "metadata.yaml"]
        shutil.copy(file, whole / f"walk_{number}{file.suffix}")
    return whole
