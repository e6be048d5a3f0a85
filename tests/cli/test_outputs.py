"""Where commands write: -o, --figure and --overwrite."""

import os
import stat
from pathlib import Path

import pytest

from dogbot_logtool.report.page.assets import shared_name
from tests.oracles.small_logs import odometry_log
from tests.shell import Shell


@pytest.fixture
def logs(tmp_path: Path) -> Path:
    """Return a directory of two small logs, one of them a directory below."""
    folder = tmp_path / "logs"
    (folder / "far").mkdir(parents=True)
    odometry_log(folder / "one.mcap", "/odom")
    odometry_log(folder / "far" / "two.mcap", "/odom")
    return folder


@pytest.mark.parametrize("name", ["out/", "out/deeper/"])
def test_a_trailing_slash_means_a_directory_for_one_log_too(
    shell: Shell, logs: Path, name: str
) -> None:
    done = shell("convert", logs / "one.mcap", "-o", name)
    assert done.code == 0
    target = shell.folder / name / "one.annotated.mcap"
    assert target.is_file()
    assert [file for file in shell.folder.rglob("*") if file.is_file()] == [target]


def test_outputs_lie_as_the_logs_of_a_directory_do(shell: Shell, logs: Path) -> None:
    assert shell("convert", logs, "-o", "out", "--jobs", 1).code == 0
    assert (shell.folder / "out" / "one.annotated.mcap").is_file()
    assert (shell.folder / "out" / "far" / "two.annotated.mcap").is_file()


@pytest.mark.parametrize("kind", ["directory", "glob", "list"])
def test_what_may_hold_several_logs_makes_a_directory_also_for_one(
    shell: Shell, logs: Path, kind: str
) -> None:
    (shell.folder / "list").write_text(f"{logs}/far/two.mcap\n")
    word = {"directory": logs / "far", "glob": f"{logs}/far/*.mcap", "list": "@list"}[kind]
    assert shell("convert", word, "-o", "out").code == 0
    assert (shell.folder / "out" / "two.annotated.mcap").is_file()
    # One log and the name of one file: that is what is meant.
    assert shell("convert", word, "-o", "x.mcap").code == 0
    assert (shell.folder / "x.mcap").is_file()


def test_a_directory_is_not_made_for_nothing(shell: Shell, logs: Path) -> None:
    (logs / "one.mcap").write_bytes(b"no log")
    assert shell("convert", logs / "one.mcap", "-o", "out/").code == 1
    assert shell("convert", logs / "one.mcap", logs / "one.mcap", "-o", "out").code == 1
    assert shell.files() == []


def test_a_file_is_no_directory(shell: Shell, logs: Path) -> None:
    (shell.folder / "out").write_text("precious")
    for words in (["out/"], ["out/deeper/"]):
        done = shell("convert", logs / "one.mcap", "-o", *words)
        assert done.code == 2
        assert "out: is a file, not a folder" in done.err
    assert (shell.folder / "out").read_text() == "precious"


@pytest.mark.parametrize("name", ["out/", "out"])
def test_pages_go_into_a_directory(shell: Shell, logs: Path, name: str) -> None:
    words = [logs / "one.mcap", *([logs / "far" / "two.mcap"] if name == "out" else [])]
    assert shell("report", *words, "-o", name).code == 0
    found = sorted(file.name for file in (shell.folder / "out").iterdir())
    pages = ["one.report.html", "two.report.html"][: len(words)]
    beside = [shared_name(), "index.html"] if len(words) > 1 else []
    assert found == sorted([*beside, *pages])


def test_overwriting_keeps_what_kind_of_file_there_was(shell: Shell, logs: Path) -> None:
    private, link = shell.folder / "private.mcap", shell.folder / "link.mcap"
    private.write_text("old")
    private.chmod(0o600)
    link.symlink_to("private.mcap")
    fifo = shell.folder / "fifo.mcap"
    os.mkfifo(fifo)
    assert shell("convert", logs / "one.mcap", "-o", link.name, "--overwrite").code == 0
    assert link.is_symlink()
    assert stat.S_IMODE(private.stat().st_mode) == 0o600
    assert private.stat().st_size > len("old")
    done = shell("convert", logs / "one.mcap", "-o", fifo.name, "--overwrite")
    assert done.code == 2
    assert "is a named pipe, not a file" in done.err
    assert fifo.is_fifo()
