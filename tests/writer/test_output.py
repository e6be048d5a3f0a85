"""Output that cannot be half."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path, PurePath

import pytest
from upath import UPath

from dogbot_logtool.errors import CallError, LogtoolError
from dogbot_logtool.writer.output import refuse_bad_target, targets, whole_file


def files(folder: Path) -> list[str]:
    return sorted(file.name for file in folder.iterdir())


def test_a_whole_file_appears_at_the_end(tmp_path: Path) -> None:
    target = tmp_path / "x.mcap"
    with whole_file(target, overwrite=False) as file:
        file.write(b"whole")
        assert not target.exists()
        (part,) = tmp_path.iterdir()
        assert part.name.startswith(".dogbot-logtool.")
        assert part.name.endswith(".part")
    assert target.read_bytes() == b"whole"
    assert files(tmp_path) == ["x.mcap"]


def write(target: Path, *pieces: bytes, overwrite: bool = False) -> None:
    with whole_file(target, overwrite=overwrite) as file:
        for piece in pieces:
            file.write(piece)


def fail_midway(target: Path, error: type[BaseException], *, overwrite: bool) -> None:
    with whole_file(target, overwrite=overwrite) as file:
        file.write(b"half")
        raise error


@pytest.mark.parametrize("error", [ValueError, LogtoolError, KeyboardInterrupt, SystemExit])
def test_any_error_leaves_nothing(tmp_path: Path, error: type[BaseException]) -> None:
    with pytest.raises(error):
        fail_midway(tmp_path / "x.mcap", error, overwrite=False)
    assert files(tmp_path) == []


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_an_error_leaves_the_old_file(tmp_path: Path, error: type[BaseException]) -> None:
    target = tmp_path / "x.mcap"
    target.write_bytes(b"old")
    with pytest.raises(error):
        fail_midway(target, error, overwrite=True)
    assert target.read_bytes() == b"old"
    assert files(tmp_path) == ["x.mcap"]


def test_overwriting(tmp_path: Path) -> None:
    target = tmp_path / "x.mcap"
    target.write_bytes(b"old")
    with whole_file(target, overwrite=True) as file:
        file.write(b"new")
        assert target.read_bytes() == b"old"
    assert target.read_bytes() == b"new"
    assert files(tmp_path) == ["x.mcap"]


def test_a_target_that_comes_to_exist_meanwhile_is_kept(tmp_path: Path) -> None:
    target = tmp_path / "x.mcap"

    def write_while_another_does() -> None:
        with whole_file(target, overwrite=False) as file:
            file.write(b"new")
            target.write_bytes(b"someone else's")

    with pytest.raises(CallError, match="exists already"):
        write_while_another_does()
    assert target.read_bytes() == b"someone else's"
    assert files(tmp_path) == ["x.mcap"]


def test_a_link_to_nowhere_is_kept(tmp_path: Path) -> None:
    target = tmp_path / "x.mcap"
    target.symlink_to(tmp_path / "nowhere")
    with pytest.raises(CallError):
        write(target, b"new")
    assert files(tmp_path) == ["x.mcap"]
    assert target.is_symlink()


@pytest.mark.parametrize("mask", [0o022, 0o077, 0o002, 0])
def test_permissions_follow_the_umask(tmp_path: Path, mask: int) -> None:
    before = os.umask(mask)
    try:
        with whole_file(tmp_path / "x.mcap", overwrite=False) as file:
            file.write(b"whole")
        (tmp_path / "y").write_bytes(b"")
    finally:
        assert os.umask(before) == mask
    plain = (tmp_path / "y").stat().st_mode
    assert (tmp_path / "x.mcap").stat().st_mode == plain


@pytest.mark.parametrize("name", ["missing/x.mcap", "file/x.mcap"])
def test_a_folder_that_is_none(tmp_path: Path, name: str) -> None:
    (tmp_path / "file").write_bytes(b"")
    target = tmp_path / name
    with pytest.raises(LogtoolError, match="cannot be written"):
        write(target, b"never")
    with pytest.raises(CallError, match="no such folder"):
        refuse_bad_target(target, None, overwrite=False)
    assert files(tmp_path) == ["file"]


@pytest.fixture
def readonly(tmp_path: Path) -> Iterator[Path]:
    """Return a folder that not even root may write to."""
    folder = tmp_path / "readonly"
    folder.mkdir()
    if os.geteuid() != 0:
        folder.chmod(0o555)
        yield folder
        folder.chmod(0o755)
        return
    _mount(folder, "ro,size=64k")
    try:
        yield folder
    finally:
        _unmount(folder)


@pytest.fixture
def tiny(tmp_path: Path) -> Iterator[Path]:
    """Return a folder on a disk of 64 kB."""
    folder = tmp_path / "tiny"
    folder.mkdir()
    _mount(folder, "size=64k")
    try:
        yield folder
    finally:
        _unmount(folder)


def _mount(folder: Path, options: str) -> None:
    mount = shutil.which("mount")
    if mount is None or os.geteuid() != 0:
        pytest.skip("only root can mount a small disk")
    command = [mount, "-t", "tmpfs", "-o", options, "tmpfs", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603
    if done.returncode:
        pytest.skip(f"a small disk cannot be mounted here: {done.stderr.strip()}")


def _unmount(folder: Path) -> None:
    umount = shutil.which("umount")
    assert umount is not None
    subprocess.run([umount, str(folder)], check=True)  # noqa: S603


def test_a_readonly_folder(readonly: Path) -> None:
    target = readonly / "x.mcap"
    with pytest.raises(LogtoolError, match=r"cannot be written: (Read-only|Permission)") as caught:
        write(target, b"never")
    assert caught.value.exit_code == 1
    assert files(readonly) == []


@pytest.mark.parametrize("piece", [1000, 1 << 20], ids=["amid pieces", "in one piece"])
def test_a_full_disk(tiny: Path, piece: int) -> None:
    old = tiny / "old"
    old.write_bytes(b"old")
    target = tiny / "x.mcap"
    with pytest.raises(LogtoolError, match="cannot be written: No space left"):
        write(target, *[bytes(piece)] * 100)
    assert files(tiny) == ["old"]
    assert old.read_bytes() == b"old"


def test_a_disk_that_fills_with_the_last_bytes(tiny: Path) -> None:
    """The last bytes are written when the file is closed."""
    (tiny / "filler").write_bytes(bytes(60_000))
    with pytest.raises(LogtoolError, match="No space left"):
        write(tiny / "x.mcap", bytes(8_000))
    assert files(tiny) == ["filler"]


def test_bad_targets(tmp_path: Path) -> None:
    log = tmp_path / "log.bag"
    log.write_bytes(b"log")
    with pytest.raises(CallError, match="is a directory"):
        refuse_bad_target(tmp_path, None, overwrite=True)
    with pytest.raises(CallError, match="input itself"):
        refuse_bad_target(tmp_path / "." / "log.bag", log, overwrite=True)
    link = tmp_path / "link"
    link.hardlink_to(log)
    with pytest.raises(CallError, match="input itself"):
        refuse_bad_target(link, log, overwrite=True)
    other = tmp_path / "other"
    other.write_bytes(b"")
    with pytest.raises(CallError, match="--overwrite"):
        refuse_bad_target(other, log, overwrite=False)
    refuse_bad_target(other, log, overwrite=True)
    refuse_bad_target(tmp_path / "new", log, overwrite=False)
    assert log.read_bytes() == b"log"


def test_targets() -> None:
    here = Path("walk.bag")
    assert targets([here], None, ".annotated.mcap") == [(here, Path("walk.annotated.mcap"))]
    assert targets([here], Path("x.mcap"), ".annotated.mcap") == [(here, Path("x.mcap"))]


def test_targets_in_a_directory(tmp_path: Path) -> None:
    logs = [Path("a/walk.bag"), Path("b/run.mcap")]
    names = [target.name for _, target in targets(logs, tmp_path, ".report.html")]
    assert names == ["walk.report.html", "run.report.html"]
    with pytest.raises(CallError, match="is no directory"):
        targets(logs, tmp_path / "none.mcap", ".report.html")
    with pytest.raises(CallError, match="same name"):
        targets([Path("a/walk.bag"), Path("b/walk.bag")], tmp_path, ".mcap")


def test_targets_lie_as_their_logs_do_and_a_url_is_a_directory_without_a_suffix() -> None:
    logs = [Path("a/walk.bag"), Path("b/walk.bag")]
    below = [PurePath(), PurePath("b")]
    folder = UPath("memory://out")
    found = [str(target) for _, target in targets(logs, folder, ".mcap", below)]
    assert found == [f"{folder}/walk.mcap", f"{folder}/b/walk.mcap"]
    assert targets(logs[:1], folder / "x.mcap", ".mcap") == [(logs[0], folder / "x.mcap")]
