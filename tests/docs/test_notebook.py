"""The notebook runs, and prints what is committed."""

import json
from typing import Any

import matplotlib as mpl
import pytest
from notebook import NOTEBOOK, executed


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


def test_the_notebook_is_small_and_imports_no_more_than_the_public_names() -> None:
    assert NOTEBOOK.stat().st_size < 100_000
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    source = "\n".join("".join(cell["source"]) for cell in notebook["cells"])
    imported = [line for line in source.splitlines() if line.startswith(("import ", "from "))]
    assert [line for line in imported if "dogbot" in line] == ["import dogbot_logtool as dl"]
