"""Where the output of each log goes."""

from pathlib import Path

import pytest

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.targets import (
    Output,
    may_be_several,
    output_at,
    targets,
)

MCAP = ".annotated.mcap"


@pytest.mark.parametrize(
    ("word", "several", "is_folder"),
    [
        ("annotated/", False, True),
        ("annotated", False, False),
        ("annotated", True, True),
        ("x.mcap", False, False),
        ("x.mcap", True, False),
        ("x.mcap/", False, True),
        ("there", False, True),
        ("there.mcap", True, True),
        ("x.v2", False, False),
        ("memory://out", False, True),
        ("memory://out/x.mcap", False, False),
    ],
)
def test_what_an_output_means(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    word: str,
    *,
    several: bool,
    is_folder: bool,
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("there", "there.mcap"):
        (tmp_path / name).mkdir()
    output = output_at(word, MCAP, several=several)
    assert output.is_folder == is_folder
    assert str(output.path).rstrip("/") == word.rstrip("/")


@pytest.mark.parametrize(
    ("name", "ending"),
    [
        ("x.bag", MCAP),
        ("x.BAG", MCAP),
        ("x.db3", MCAP),
        ("x.html", MCAP),
        ("x.json", MCAP),
        ("x.mcap.zstd", MCAP),
        ("memory://out/x.bag", MCAP),
        ("x.mcap", ".report.html"),
        ("x.pdf", ".report.html"),
    ],
)
@pytest.mark.parametrize("several", [False, True])
def test_a_name_must_not_promise_another_format(name: str, ending: str, *, several: bool) -> None:
    with pytest.raises(CallError, match="the name is that of") as caught:
        output_at(name, ending, several=several)
    assert f"name it x.{ending.rpartition('.')[2]}" in str(caught.value)


def test_a_dash_is_no_file() -> None:
    with pytest.raises(CallError, match="does not stand for stdout"):
        output_at("-", MCAP, several=False)


def test_words_that_may_name_several_logs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    log = Path("logs") / "a.bag"
    assert not may_be_several(["logs/a.bag"], [log])
    assert not may_be_several(["./logs/a.bag"], [log.absolute()])
    for word in ("logs", "logs/*.bag", "@list"):
        assert may_be_several([word], [log])
    assert may_be_several(["logs/a.bag", "logs/a.bag"], [log])


def test_targets() -> None:
    here = Path("walk.bag")
    assert targets([here], Output(Path(), is_folder=True), MCAP) == [
        (here, Path("walk.annotated.mcap"))
    ]
    assert targets([here], Output(Path("x.mcap"), is_folder=False), MCAP) == [
        (here, Path("x.mcap"))
    ]


def test_targets_in_a_directory(tmp_path: Path) -> None:
    logs = [Path("a/walk.bag"), Path("b/run.mcap")]
    folder = Output(tmp_path, is_folder=True)
    names = [target.name for _, target in targets(logs, folder, ".report.html")]
    assert names == ["walk.report.html", "run.report.html"]
    with pytest.raises(CallError, match=r"is a file's name.*such as none/"):
        targets(logs, Output(tmp_path / "none.mcap", is_folder=False), ".report.html")
    with pytest.raises(CallError, match="same name"):
        targets([Path("a/walk.bag"), Path("b/walk.bag")], folder, ".mcap")
