"""Sentences and tables on terminals of any width."""

import io
import subprocess
from pathlib import Path

import pytest
from rich.console import Console
from rich.text import Text

from dogbot_logtool.report.text.console import HangingIndent, NameTable, Row
from tests.forked_cli import run
from tests.oracles.small_logs import first_seconds
from tests.paths import SAMPLE_LOGS

TROT, TROUBLED = (
    first_seconds(SAMPLE_LOGS / f"dogbot_{name}.bag") for name in ("trot", "troubled")
)
LONG = "a_log_with_a_name_that_is_longer_than_any_column_of_a_table_in_a_terminal.bag"
TOPIC = "/a/topic/that/does/not/fit/into/a/line/of/forty/columns"


def printed(renderable: HangingIndent | NameTable, width: int) -> list[str]:
    console = Console(file=io.StringIO(), width=width)
    console.print(renderable, crop=False)
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue().splitlines()


@pytest.mark.parametrize("width", range(1, 80, 3))
def test_words_stay_whole_at_any_width(width: int) -> None:
    text = f"  note  the topic {TOPIC} has \u81ea\u884c messages"
    lines = printed(HangingIndent(Text(text), 9), width)
    assert " ".join(lines).split() == text.split()
    for line in lines[1:]:
        assert line.startswith(" " * 9)
        assert Text(line).cell_len <= width or len(line.split()) == 1


@pytest.mark.parametrize("width", range(1, 120, 7))
def test_names_stay_whole_at_any_width(width: int) -> None:
    rows = [Row(["/a", "  kind"], ["12", "x y"]), Row([TOPIC], ["3", "z"]), Row(["/b"], ["", ""])]
    table = NameTable(("topic", "long heading", "used as"), rows, left=(2,), margin=2, gap=3)
    text = "\n".join(printed(table, width))
    assert set(text.split()) >= {"/a", "kind", TOPIC, "/b", "12", "3"}
    if width >= 40:
        assert max(len(line) for line in text.splitlines() if TOPIC not in line) <= width


@pytest.mark.parametrize(
    "words",
    [
        ["info", str(TROUBLED)],
        ["info", "--frames", LONG],
        ["convert", "-v", LONG, "-o", f"x_{LONG}.mcap"],
        ["compare", str(TROT), str(TROUBLED)],
        ["stats", LONG, str(TROUBLED), "--jobs", "1"],
        ["stats", LONG, "-v"],
    ],
    ids=lambda words: words[0],
)
def test_no_command_breaks_a_word(tmp_path: Path, words: list[str]) -> None:
    (tmp_path / LONG).write_bytes(TROT.read_bytes()[:-1000])

    def output(columns: int) -> list[str]:
        for file in tmp_path.glob("x_*"):
            file.unlink()
        size = {"COLUMNS": str(columns)}
        done = run(*words, folder=tmp_path, environment=size, stderr=subprocess.STDOUT)
        return done.stdout.splitlines()

    lines = output(80)
    narrow = {word for line in lines for word in line.split()}
    wide = {word for line in output(400) for word in line.split() if word.isprintable()}
    moved = {"type", "sent"}  # headings of columns that have no room
    assert [word for word in wide - narrow - moved if len(word) > 3 and word.isascii()] == []
    assert [line for line in lines if len(line) > 80 and len(line.split()) > 1] == []


def test_a_damaged_log_is_marked_among_several(tmp_path: Path) -> None:
    (tmp_path / LONG).write_bytes(TROT.read_bytes()[:-200_000])
    done = run("stats", TROT, LONG, "--jobs", 1, folder=tmp_path)
    assert done.returncode == 3
    table = done.stdout[done.stdout.index("log ") :]
    heading, _, whole, *cut = table.splitlines()
    assert heading.split()[-2:] == ["quality", "worst"]
    assert {"OK", "USABLE", "DOUBTFUL"} & set(whole.split())
    assert "DAMAGED" in " ".join(cut)
