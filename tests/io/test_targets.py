"""Where the output of each log goes."""

from pathlib import Path

import pytest

from dogbot_logtool.io.targets import output_at

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
