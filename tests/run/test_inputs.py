"""Which logs the words of a call name."""

import contextlib
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest
from upath import UPath

from dogbot_logtool.errors import CallError, LogtoolError
from dogbot_logtool.io.storage import location, name_of
from dogbot_logtool.run.inputs import find_logs
from tests import forked_cli
from tests.paths import SAMPLE_LOGS

TROUBLED = SAMPLE_LOGS / "dogbot_troubled.bag"
MCAP = b"\x89MCAP0\r\n rest"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A lab's directory."""
    for name in (
        "b.bag",
        "a.mcap",
        "a.annotated.mcap",
        "run/walk.bag",
        "run/walk.db3.zstd",
        "run/deep/noted",
        "run/deep/notes.txt",
        "split/metadata.yaml",
        "split/one.db3",
        "split/two.db3",
        "lost/lost_0.mcap",
        "lost/lost_1.mcap",
        ".hidden/x.bag",
    ):
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(MCAP if name.endswith("noted") else b"x")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def names(*words: str) -> list[str]:
    return find_logs(words).names


def add(folder: Path, files: Mapping[str, bytes | str]) -> None:
    """Add files by their content, and links by where they lead."""
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        if isinstance(content, str):
            path.symlink_to(content)
        else:
            path.write_bytes(content)


ALL = ["a.mcap", "b.bag", "lost", "run/walk.bag", "run/walk.db3.zstd", "split"]
LINKS = {
    "again": ".",
    "up": "..",
    "root": "/",
    "a link": "run",
    "run/other": "../split",
    "a latest.bag": "run/walk.bag",
}
"""To the directory itself, those above it, each other, and to logs that are here as well."""
ODD_NAMES = {os.fsdecode(b"\xff.bag"): b"", " spaced.bag ": b"", "@at.bag": b"", "#hash.bag": b""}


@pytest.mark.parametrize(
    ("files", "words", "expected"),
    [
        ({}, ["."], ALL),
        (
            {},
            ["run/walk.bag", "*.mcap", "run", "absent.bag"],
            ["run/walk.bag", "a.annotated.mcap", "a.mcap", ALL[4], "absent.bag"],
        ),
        ({}, ["**/*.bag"], ["b.bag", "run/walk.bag"]),
        ({}, ["b.bag", "./b.bag", "run/../b.bag"], ["b.bag"]),
        # Lists
        ({"l": b"# mine\n\nb.bag\n  run \n"}, ["@l", "a.mcap"], ["b.bag", *ALL[3:5], "a.mcap"]),
        (
            # A byte-order mark, Windows' line ends, and separators that only Unicode knows.
            {"l": "\ufeffb.bag\r\n# mine\r\nodd\u2028name.bag\r\n".encode()},
            ["@l"],
            ["b.bag", "odd\u2028name.bag"],
        ),
        (
            {**ODD_NAMES, "l": b"\xff.bag\n spaced.bag \n./@at.bag\n./#hash.bag\n"},
            ["@l"],
            ["\\xff.bag", " spaced.bag ", "@at.bag", "#hash.bag"],
        ),
        # Links
        (LINKS, ["."], ALL),
        (LINKS, ["**/*.bag", "again/**/walk.bag"], ["b.bag", "run/walk.bag"]),
        (
            {"here/data": "../lost", "here/walk.bag": "../b.bag"},
            ["here"],
            ["here/data", "here/walk.bag"],
        ),
        (
            {"gone*.bag": "nowhere", "loop.bag": "loop.bag"},
            ["g*.bag", "l*.bag", "gone*.bag"],
            ["gone*.bag", "loop.bag"],
        ),
        ({"empty/notes": b""}, ["e*", "ru*"], ALL[3:5]),
    ],
)
def test_words_name_logs_each_once_in_their_order(
    folder: Path, files: Mapping[str, bytes | str], words: list[str], expected: list[str]
) -> None:
    add(folder, files)
    assert names(*words) == expected


@pytest.mark.parametrize(
    ("files", "word", "said"),
    [
        ({"l": b"\xff\xfeb\0.\0"}, "@l", "not even text"),
        ({}, "@absent.txt", r"^absent.txt: no such file"),
        ({"l": b"b.bag\n\n  @other\n"}, "@l", r"@l, line 3: @other: .*cannot name another"),
        ({"l": b"b.bag\n*.nothing\n"}, "@l", r"@l, line 2: \*\.nothing: no file"),
        ({}, "@/dev/zero", "not a regular file"),
        ({"empty/notes": b""}, "e*", "there are no logs"),
        ({}, "s3://[", r"s3://\[: cannot be opened: Invalid IPv6 URL"),
        ({}, "s3://?x", "s3://: "),
    ],
)
def test_words_that_name_no_logs_are_refused(
    folder: Path, files: Mapping[str, bytes | str], word: str, said: str
) -> None:
    add(folder, files)
    with pytest.raises(LogtoolError, match=said):
        names(word)


@pytest.mark.usefixtures("folder")
def test_logs_that_are_found_keep_their_place() -> None:
    log_set = find_logs(["."])
    assert [str(log.below) for log in log_set.logs] == [".", ".", ".", "run", "run", "."]
    assert log_set.left_out == 1


def test_a_link_to_a_directory_above_is_no_pattern_s(folder: Path) -> None:
    add(folder, LINKS)
    for pattern in ("*", "**", "**/*"):
        found = names(pattern)
        assert {*ALL[1:4]} < {*found}
        assert not any(name.startswith(("root", "up")) for name in found)


def test_special_files_do_not_block(folder: Path) -> None:
    os.mkfifo(folder / "run" / "pipe")
    assert "run/pipe" not in names("run")
    with pytest.raises(CallError, match="not a regular file"):
        names("@run/pipe")


def test_a_store_is_searched_alike(folder: Path) -> None:
    """The same files in a store."""
    root = UPath(f"memory://{folder.name}")
    for file in folder.rglob("*"):
        if file.is_file():
            target = root / file.relative_to(folder).as_posix()
            target.fs.pipe_file(target.path, file.read_bytes())
    log_set = find_logs([f"memory://{folder.name}"])
    found = [
        name.partition(f"{folder.name}/")[2] for name in log_set.names if ".hidden" not in name
    ]
    assert found == ALL
    assert {str(log.below) for log in log_set.logs if "walk" in log.path.name} == {"run"}
    assert len(names(f"memory://{folder.name}/run/*.bag")) == 1
    with pytest.raises(CallError, match="there are no logs"):
        names(f"memory://{folder.name}/run/deep")
    with pytest.raises(CallError, match="no object has such a name"):
        names(f"memory://{folder.name}/*.nothing")


def test_an_object_may_have_the_name_of_a_pattern(tmp_path: Path) -> None:
    root = UPath(f"memory://{tmp_path.name}")
    for name in ("a*.bag", "ab.bag", "c[1].bag"):
        root.fs.pipe_file((root / name).path, b"x")
    assert [name.rpartition("/")[2] for name in names(f"{root}/a*.bag", f"{root}/c[1].bag")] == [
        "a*.bag",
        "ab.bag",
        "c[1].bag",
    ]


def test_a_url_of_a_file_is_its_path() -> None:
    assert location("file:///a/b%20c.bag") == Path("/a/b c.bag")


def test_secrets_of_a_url_are_not_shown() -> None:
    assert name_of("https://me:word@host/x.bag?X-Signature=1") == "https://host/x.bag"
    assert name_of("a@b/c?d.bag") == "a@b/c?d.bag"


@pytest.fixture
def unreadable(folder: Path) -> Iterator[Path]:
    """Make a directory that cannot be listed, not even by root: its path is too long."""
    name = "d" * 250
    with contextlib.chdir(folder):
        for _ in range(17):
            Path(name).mkdir()
            os.chdir(name)
    yield folder
    shutil.rmtree(folder / name)


def test_a_directory_that_cannot_be_read_does_not_stop_the_search(unreadable: Path) -> None:
    whole = find_logs(["."])
    assert len(whole.logs) == 6
    assert [sentence.rpartition(": ")[2] for _, sentence in whole.failures] == [
        "File name too long"
    ]
    for name in ("a.mcap", "b.bag"):
        (unreadable / name).unlink()
    for name in ("run", "lost", "split"):
        shutil.rmtree(unreadable / name)
    shutil.copy(TROUBLED, unreadable / "walk.bag")
    done = forked_cli.run("stats", ".", "--json", folder=unreadable)
    assert done.returncode == 1
    assert "cannot be searched: File name too long" in done.stderr
    results = json.loads(done.stdout)
    assert [each["log"]["path"] for each in results if "log" in each] == ["walk.bag"]
    (unreadable / "walk.bag").unlink()
    with pytest.raises(LogtoolError, match="File name too long, and there are no logs elsewhere"):
        find_logs(["."])
