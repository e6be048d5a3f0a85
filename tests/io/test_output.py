"""Output that cannot be half."""

import os
from contextlib import suppress
from pathlib import Path

import pytest
from upath import UPath

from dogbot_logtool.errors import CallError, LogtoolError
from dogbot_logtool.io.output import output_at, whole_file


def files(folder: Path) -> list[str]:
    return sorted(file.name for file in folder.iterdir())


@pytest.fixture(params=["unnamed", "named"])
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Write as this system can, or as one that has no files without names."""
    if request.param == "named":
        monkeypatch.delattr(os, "O_TMPFILE", raising=False)
    elif not hasattr(os, "O_TMPFILE"):
        pytest.skip("this system has no files without names")
    return str(request.param)


def test_a_whole_file_appears_at_the_end(tmp_path: Path, way: str) -> None:
    target = tmp_path / "x.mcap"
    with whole_file(target, overwrite=False) as file:
        file.write(b"whole")
        assert not target.exists()
        parts = files(tmp_path)
        assert len(parts) == (0 if way == "unnamed" else 1)
        assert all(part.startswith(".dogbot-logtool.") for part in parts)
        assert all(part.endswith(".part") for part in parts)
    assert target.read_bytes() == b"whole"
    assert files(tmp_path) == ["x.mcap"]


def fail_midway(target: Path, error: type[BaseException]) -> None:
    with whole_file(target, overwrite=False) as file:
        file.write(b"half")
        raise error


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
@pytest.mark.usefixtures("way")
def test_any_error_leaves_nothing(tmp_path: Path, error: type[BaseException]) -> None:
    with pytest.raises(error):
        fail_midway(tmp_path / "made" / "x.mcap", error)
    assert files(tmp_path) == []


@pytest.mark.usefixtures("way")
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


@pytest.mark.usefixtures("way")
@pytest.mark.parametrize("mask", [0o022, 0o077])
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


@pytest.mark.parametrize("fails", [True, False])
def test_an_object_is_there_when_it_is_whole(tmp_path: Path, *, fails: bool) -> None:
    target = UPath(f"file://{tmp_path}/x.mcap")
    assert not isinstance(target, Path)
    with suppress(SystemExit), whole_file(target, overwrite=False) as file:
        file.write(b"perhaps")
        if fails:
            raise SystemExit
    assert files(tmp_path) == ["x.mcap"] * (not fails)


@pytest.mark.skipif(not Path("/sys").is_dir(), reason="no folder here is closed to everyone")
def test_a_folder_that_nobody_may_write_to() -> None:
    with pytest.raises(LogtoolError, match=r"cannot be written: (Read-only|Permission)") as caught:
        fail_midway(Path("/sys/x.mcap"), KeyError)
    assert caught.value.exit_code == 1


@pytest.mark.parametrize(
    ("word", "is_folder"), [("there", True), ("memory://out", True), ("memory://x.mcap", False)]
)
def test_what_an_output_means(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, word: str, *, is_folder: bool
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").mkdir()
    output = output_at(word, ".annotated.mcap", several=False)
    assert output.is_folder == is_folder
    assert str(output.path).rstrip("/") == word
