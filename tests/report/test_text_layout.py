"""Sentences and tables on terminals of any width."""

import subprocess
from pathlib import Path

import pytest

from tests.forked_cli import run
from tests.oracles.small_logs import first_seconds
from tests.paths import TROT, TROUBLED

LONG = "a_log_with_a_name_that_is_longer_than_any_column_of_a_table_in_a_terminal.bag"


@pytest.mark.parametrize(
    "words",
    [
        ["info", "TROUBLED"],
        ["info", "--frames", LONG],
        ["convert", "-v", LONG, "-o", f"x_{LONG}.mcap"],
        ["compare", "TROT", "TROUBLED"],
        ["stats", LONG, "TROUBLED", "--jobs", "1"],
        ["stats", LONG, "-v"],
    ],
    ids=lambda words: words[0],
)
def test_no_command_breaks_a_word(tmp_path: Path, words: list[str]) -> None:
    (tmp_path / LONG).write_bytes(first_seconds(TROT).read_bytes()[:-1000])
    logs = {"TROT": first_seconds(TROT), "TROUBLED": first_seconds(TROUBLED)}
    call = [logs.get(word, word) for word in words]

    def output(columns: int) -> list[str]:
        for file in tmp_path.glob("x_*"):
            file.unlink()
        size = {"COLUMNS": str(columns)}
        done = run(*call, folder=tmp_path, environment=size, stderr=subprocess.STDOUT)
        return done.stdout.splitlines()

    lines = output(80)
    narrow = {word for line in lines for word in line.split()}
    wide = {word for line in output(400) for word in line.split() if word.isprintable()}
    moved = {"type", "sent"}  # headings of columns that have no room
    assert [word for word in wide - narrow - moved if len(word) > 3 and word.isascii()] == []
    assert [line for line in lines if len(line) > 80 and len(line.split()) > 1] == []


def test_a_damaged_log_is_marked_among_several(tmp_path: Path) -> None:
    (tmp_path / LONG).write_bytes(first_seconds(TROT).read_bytes()[:-200_000])
    done = run("stats", first_seconds(TROT), LONG, "--jobs", 1, folder=tmp_path)
    assert done.returncode == 3
    table = done.stdout[done.stdout.index("log ") :]
    heading, _, whole, *cut = table.splitlines()
    assert heading.split()[-2:] == ["quality", "worst"]
    assert {"OK", "USABLE", "DOUBTFUL"} & set(whole.split())
    assert "DAMAGED" in " ".join(cut)
