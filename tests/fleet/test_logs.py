"""Which logs the words of a call name."""

from pathlib import Path

import pytest
from upath import UPath

from dogbot_logtool.errors import CallError
from dogbot_logtool.fleet.logs import find_logs
from dogbot_logtool.storage import location, shown

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


@pytest.mark.usefixtures("folder")
def test_a_directory_is_searched_and_a_ros2_bag_is_one_log() -> None:
    fleet = find_logs(["."])
    assert fleet.names == [
        "a.mcap",
        "b.bag",
        "lost",
        "run/deep/noted",
        "run/walk.bag",
        "run/walk.db3.zstd",
        "split",
    ]
    assert [str(below) for below in fleet.below] == [".", ".", ".", "run/deep", "run", "run", "."]
    assert fleet.left_out == 1


@pytest.mark.usefixtures("folder")
def test_words_keep_their_order_and_each_log_is_there_once() -> None:
    assert names("run/walk.bag", "*.mcap", "run", "absent.bag") == [
        "run/walk.bag",
        "a.annotated.mcap",
        "a.mcap",
        "run/deep/noted",
        "run/walk.db3.zstd",
        "absent.bag",
    ]
    assert names("**/*.bag") == ["b.bag", "run/walk.bag"]


def test_a_list_names_logs(folder: Path) -> None:
    (folder / "list.txt").write_text("# mine\n\nb.bag\n  run \n")
    assert names("@list.txt", "a.mcap")[::4] == ["b.bag", "a.mcap"]
    (folder / "ours.txt").write_text("a.annotated.mcap\n")
    assert names("@ours.txt") == ["a.annotated.mcap"]
    (folder / "odd.txt").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(CallError, match="not even text"):
        names("@odd.txt")
    with pytest.raises(CallError, match=r"^@absent.txt: no such file"):
        names("@absent.txt")


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("word", "sentence"),
    [
        ("*.nothing", "no file has such a name"),
        (".hidden/..x*", "no file"),
        ("s3x://y", "no known kind"),
    ],
)
def test_a_word_that_names_nothing_is_a_wrong_call(word: str, sentence: str) -> None:
    with pytest.raises(CallError, match=sentence):
        names(word)


def test_workers_are_told_whole_paths(folder: Path) -> None:
    assert find_logs(["run", "b.bag"], for_workers=True).places[-1] == folder / "b.bag"


def test_a_directory_without_logs_is_a_wrong_call(tmp_path: Path) -> None:
    with pytest.raises(CallError, match="holds no logs"):
        names(str(tmp_path))


def test_a_store_is_searched_alike(folder: Path) -> None:
    """The same files in a store, but for those that only their first bytes betray."""
    root = UPath(f"memory://{folder.name}")
    for file in folder.rglob("*"):
        if file.is_file():
            target = root / file.relative_to(folder).as_posix()
            target.fs.pipe_file(target.path, file.read_bytes())
    fleet = find_logs([f"memory://{folder.name}"])
    expected = ["a.mcap", "b.bag", "lost", "run/walk.bag", "run/walk.db3.zstd", "split"]
    found = [name.partition(f"{folder.name}/")[2] for name in fleet.names if ".hidden" not in name]
    assert found == expected
    below = dict(zip(fleet.names, map(str, fleet.below), strict=True))
    assert {place for name, place in below.items() if "walk" in name} == {"run"}
    assert len(names(f"memory://{folder.name}/run/*.bag")) == 1
    with pytest.raises(CallError, match="no object has such a name"):
        names(f"memory://{folder.name}/*.nothing")


def test_urls_are_told_from_paths() -> None:
    assert location("file:///a%20b/c.bag") == Path("/a b/c.bag")
    assert location("a/b:c.bag") == Path("a/b:c.bag")
    with pytest.raises(CallError, match="of no known kind"):
        location("nonsense://a")


def test_secrets_of_a_url_are_not_shown() -> None:
    assert shown("https://me:word@host/x.bag?X-Signature=1") == "https://host/x.bag"
    assert shown("a@b/c?d.bag") == "a@b/c?d.bag"
