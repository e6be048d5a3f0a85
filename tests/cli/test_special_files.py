"""Files that are no regular ones, and small ones that take their parser's time or memory."""

import os
import re
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from dogbot_logtool.robot.robot import load_robot
from tests import forked_cli
from tests.forked_cli import Ended
from tests.paths import ROOT, TROT, TROUBLED
from tests.reader.mcap_bytes import small_mcap

MOST_SECONDS = 30


def run(*words: str | Path) -> Ended:
    return forked_cli.run(*words, timeout=MOST_SECONDS)


def pipe(folder: Path) -> Path:
    path = folder / "pipe.toml"
    os.mkfifo(path)
    return path


def device(folder: Path) -> Path:
    path = folder / "device.toml"
    path.symlink_to("/dev/zero")
    return path


def directory(folder: Path) -> Path:
    path = folder / "directory.toml"
    path.mkdir()
    return path


def listening(folder: Path) -> Path:
    path = folder / "s.toml"
    previous = Path.cwd()
    # The name of a socket may be no longer than a hundred bytes.
    os.chdir(folder)
    try:
        with socket.socket(socket.AF_UNIX) as end:
            end.bind(path.name)
    finally:
        os.chdir(previous)
    return path


SPECIAL: dict[str, Callable[[Path], Path]] = {
    "a named pipe": pipe,
    "a device": device,
    "a socket": listening,
    "a directory": directory,
}


@pytest.mark.parametrize("kind", SPECIAL)
def test_files_that_are_not_regular_are_refused(tmp_path: Path, kind: str) -> None:
    path = SPECIAL[kind](tmp_path)
    log = tmp_path / "walk.mcap"
    log.write_bytes(small_mcap().build())
    calls: list[tuple[str | Path, ...]] = [
        ("info", "--robot", path, log),
        ("compare", "--tolerances", path, log, log),
        ("convert", "--urdf", path, TROT, "-o", tmp_path / "out.mcap"),
        ("check", "--limits", path, log),
    ]
    if kind != "a directory":
        calls += [(command, path) for command in ("info", "convert", "layout")]
        calls += [("compare", log, path)]
    for call in calls:
        done = run(*call)
        assert done.returncode == 2, done.stderr
        assert f"{path}: is {kind}, not a regular file" in done.stderr.replace("\n", "")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("mass_kg = [\n" + "1,\n" * 5000 + "]\n", "mass_kg is [1, 1"),
        ("strange = [\n" + "1,\n" * 5000 + "]\n", "the key strange is not known"),
        ("strange = '''\n" + '"""[\n' * 5000 + "'''\n", "the key strange is not known"),
        ("\n" * 20_000 + "strange = 1", "the key strange is not known"),
        ("mass_kg = " + "9" * 5000, "too many digits"),
        ("mass_kg = " + "9" * 4000, "mass_kg is 9999"),
        ("mass_kg = 0x" + "f" * 90_000, "mass_kg is too long to show"),
        ("mass_kg = 1e999", "mass_kg is inf"),
        ("mass_kg = " + "[" * 50_000 + "]" * 50_000, "nested too deeply"),
        ("mass_kg = " + "{a=" * 50_000, "nested too deeply"),
        ("a." * 50_000 + "b = 1", "line 2: a key has more than 16 parts"),
        ("[" + "'a' . " * 20_000 + "b]", "line 2: a key has more than 16 parts"),
        ("a" * 200_000 + " = 1", "the key aaa"),
        ("#" * 300_000, "larger than 256 kB"),
    ],
)
def test_hostile_toml_is_refused_at_once(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "robot.toml"
    path.write_text("name = 'x'\n" + text)
    done = run("info", "--robot", path, _log(tmp_path))
    assert done.returncode == 2, done.stderr
    assert says in done.stderr
    assert "Traceback" not in done.stderr


def _log(folder: Path) -> Path:
    path = folder / "walk.mcap"
    path.write_bytes(small_mcap().build())
    return path


def test_a_byte_order_mark_does_not_matter(tmp_path: Path) -> None:
    path = tmp_path / "robot.toml"
    path.write_text("name = 'from Windows'\r\nmass_kg = 12.0\r\n", encoding="utf-8-sig")
    assert load_robot(str(path)).name == "from Windows"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('{"a": ' + "9" * 5000 + "}", "value has 5000 digits\n"),
        ("[" * 100_000, "nested too deeply"),
        ('{"a":' * 5000 + "1" + "}" * 5000, "nested too deeply"),
    ],
)
def test_hostile_json_is_refused(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "stats.json"
    path.write_text(text)
    done = run("compare", path, path)
    assert done.returncode == 1
    assert says in done.stderr


@pytest.mark.parametrize(
    "words",
    [
        "info {name}",
        "stats {name} --json",
        "convert {name} -o out/",
        "report {name} -o out/",
        "layout {name}",
        "compare {name} {name}",
        "convert {log} -o {name}",
    ],
)
def test_a_name_that_no_disk_takes_is_told(tmp_path: Path, words: str) -> None:
    done = forked_cli.run(*words.format(name="x" * 5000, log=TROUBLED).split(), folder=tmp_path)
    assert done.returncode in {1, 2}
    assert "File name too long" in done.stderr
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "words", ["convert log.mcap", "info .", "export log.mcap --dataset runs", "info log.mcap"]
)
def test_a_current_directory_that_was_removed_is_told(tmp_path: Path, words: str) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    script = f'cd {folder} && rmdir {folder} && exec "$@"'
    done = subprocess.run(  # noqa: S603 - our own interpreter
        ["/bin/sh", "-c", script, "sh", sys.executable, "-m", "dogbot_logtool", *words.split()],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert done.returncode in {1, 2}, done.stderr
    assert re.search("current directory was removed|no such file", done.stderr)
    assert "Traceback" not in done.stderr
