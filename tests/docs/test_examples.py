"""The docs show what the program prints of the sample logs."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.forked_cli import run
from tests.paths import ROOT, SAMPLE_LOGS

PAGES = [ROOT / "README.md", *(ROOT / "docs" / f"{name}.md" for name in ("tutorial", "stats"))]


def examples(page: Path) -> Iterator[tuple[str, list[str]]]:
    """Commands on sample logs, and the lines that stand below each."""
    for block in re.findall(r"(?ms)^```\n(.*?)^```", page.read_text(encoding="utf-8")):
        parts = re.split(r"(?m)^\$ ", block)[1:]
        for command, _, shown in (part.partition("\n") for part in parts):
            if command.startswith("dogbot-logtool ") and "sample_logs/" in command and shown:
                yield command, shown.splitlines()


@pytest.mark.parametrize(
    ("command", "shown"),
    [pytest.param(*each, id=each[0]) for page in PAGES for each in examples(page)],
)
def test_what_is_shown_is_printed(tmp_path: Path, command: str, shown: list[str]) -> None:
    """A line of three dots stands for any lines, and a page's size is about as shown."""
    (tmp_path / SAMPLE_LOGS.name).symlink_to(SAMPLE_LOGS)
    ended = run(*shlex.split(command)[1:], folder=tmp_path)
    printed = "\n".join(line.rstrip() for line in (ended.stdout + ended.stderr).splitlines())
    pattern = "\n".join(".*" if line.strip() == "..." else re.escape(line) for line in shown)
    pattern = re.sub(r"\d\\\.\d+(?=\\ MB\\\))", r"\\d\\.\\d+", pattern)
    assert re.fullmatch(pattern, printed, re.DOTALL), printed
