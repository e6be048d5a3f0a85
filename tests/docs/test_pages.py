"""Made pages are up to date, examples are printed, links lead somewhere, the notebook runs."""

import json
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest
from notebook import NOTEBOOK, executed
from pages import PAGES

from hatch_build import long_description
from tests.forked_cli import run
from tests.paths import ROOT, SAMPLE_LOGS


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_page_is_up_to_date(page: Path) -> None:
    assert page.read_text(encoding="utf-8") == PAGES[page](), "run: make docs"


EXAMPLES = [ROOT / "README.md", *(ROOT / "docs" / f"{name}.md" for name in ("tutorial", "stats"))]


def examples(page: Path) -> Iterator[tuple[str, list[str]]]:
    """Commands on sample logs, and the lines that stand below each."""
    for block in re.findall(r"(?ms)^```\n(.*?)^```", page.read_text(encoding="utf-8")):
        parts = re.split(r"(?m)^\$ ", block)[1:]
        for command, _, shown in (part.partition("\n") for part in parts):
            if command.startswith("dogbot-logtool ") and "sample_logs/" in command and shown:
                yield command, shown.splitlines()


@pytest.mark.parametrize(
    ("command", "shown"),
    [pytest.param(*each, id=each[0]) for page in EXAMPLES for each in examples(page)],
)
def test_what_is_shown_is_printed(tmp_path: Path, command: str, shown: list[str]) -> None:
    """A line of three dots stands for any lines, and a page's size is about as shown."""
    (tmp_path / SAMPLE_LOGS.name).symlink_to(SAMPLE_LOGS)
    ended = run(*shlex.split(command)[1:], folder=tmp_path)
    printed = "\n".join(line.rstrip() for line in (ended.stdout + ended.stderr).splitlines())
    pattern = "\n".join(".*" if line.strip() == "..." else re.escape(line) for line in shown)
    pattern = re.sub(r"\d\\\.\d+(?=\\ MB\\\))", r"\\d\\.\\d+", pattern)
    assert re.fullmatch(pattern, printed, re.DOTALL), printed


# --- The notebook ---------------------------------------------------------------------------------


def texts(notebook: dict[str, Any]) -> list[Any]:
    """What cells print and return, without figures, whose pixels depend on matplotlib's version."""
    outputs = [output for cell in notebook["cells"] for output in cell.get("outputs", ())]
    return [each.get("text") or each["data"]["text/plain"] for each in outputs]


def test_the_notebook_runs_and_prints_what_is_committed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(NOTEBOOK.parent)
    mpl.use("Agg")
    committed = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    made = executed(committed)
    assert texts(made) == texts(committed), "run: make docs"
    figures = [each for cell in made["cells"] for each in cell.get("outputs", ()) if "data" in each]
    assert sum("image/png" in each["data"] for each in figures) == 2


# --- Links ----------------------------------------------------------------------------------------


LINKED = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"(?m)^#+ +(.+)$")


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as viewers of Markdown make them."""
    words = (re.sub(r"[^\w\- ]", "", heading.lower()) for heading in HEADING.findall(prose(page)))
    return {heading.strip().replace(" ", "-") for heading in words}


def prose(page: Path) -> str:
    """Return a page without its blocks of code."""
    return re.sub(r"(?ms)^```.*?^```", "", page.read_text())


def broken(page: Path) -> Iterator[str]:
    """Yield the links of a page that lead nowhere."""
    for link in LINK.findall(prose(page)):
        if link.startswith(("http://", "https://")):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if not target.exists() or (anchor and anchor not in anchors(target)):
            yield link


@pytest.mark.parametrize("page", LINKED, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    assert list(broken(page)) == []


# --- What a package index shows -------------------------------------------------------------------


def test_links_become_words_or_lead_into_the_repository() -> None:
    text = "![A walk](docs/walk.png)\nSee [the\nfigures](docs/metrics.md#feet), [mcap](https://mcap.dev).\n"
    assert long_description(text, "", "1.2.3") == ("See the\nfigures, [mcap](https://mcap.dev).\n")
    assert long_description(text, "https://example.org/x", "1.2.3") == (
        "![A walk](https://example.org/x/raw/v1.2.3/docs/walk.png)\n"
        "See [the\nfigures](https://example.org/x/blob/v1.2.3/docs/metrics.md#feet), "
        "[mcap](https://mcap.dev).\n"
    )
