"""Runs the notebook and writes what its cells print and draw: ``python docs/notebook.py``.

It runs code cells in order, in this process, as Jupyter does: what a cell prints, the value of its
last line, and its figures are its outputs.
"""

import ast
import base64
import contextlib
import io
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl

NOTEBOOK: Final = Path(__file__).parent / "walk.ipynb"
_DPI: Final = 60

Json = dict[str, Any]


def executed(notebook: Json) -> Json:
    """Return a notebook with the outputs of its cells; an error of a cell is raised.

    Args:
        notebook: as JSON; it is not changed.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    number = 0
    cells = []
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            cells.append(cell)
            continue
        number += 1
        outputs = _outputs("".join(cell["source"]), names, number)
        cells.append({**cell, "execution_count": number, "outputs": outputs})
    return {**notebook, "cells": cells}


def _outputs(source: str, names: dict[str, Any], number: int) -> list[Json]:
    """Run a cell; return its outputs."""
    printed, value = io.StringIO(), None
    tree = ast.parse(source)
    last = tree.body[-1] if tree.body else None
    if isinstance(last, ast.Expr):
        tree.body.pop()
    with contextlib.redirect_stdout(printed), _shown_later():
        exec(compile(tree, f"cell {number}", "exec"), names)  # noqa: S102 - our own notebook
        if isinstance(last, ast.Expr):
            expression = compile(ast.Expression(last.value), f"cell {number}", "eval")
            value = eval(expression, names)  # noqa: S307
    outputs: list[Json] = []
    if printed.getvalue():
        outputs.append({"name": "stdout", "output_type": "stream", "text": _lines(printed)})
    if value is not None:
        data = {"text/plain": _lines(io.StringIO(repr(value)))}
        outputs.append(
            {
                "data": data,
                "execution_count": number,
                "metadata": {},
                "output_type": "execute_result",
            }
        )
    return [*outputs, *_figures()]


@contextlib.contextmanager
def _shown_later() -> Iterator[None]:
    """Let `show` do nothing: figures are outputs when the cell has ended."""
    from matplotlib import pyplot as plt  # noqa: PLC0415 - behind the choice of its backend

    show, plt.show = plt.show, lambda *_, **__: None
    try:
        yield
    finally:
        plt.show = show


def _lines(text: io.StringIO) -> list[str]:
    return text.getvalue().splitlines(keepends=True)


def _figures() -> list[Json]:
    """Return the figures that are open, and close them."""
    from matplotlib import pyplot as plt  # noqa: PLC0415 - behind the choice of its backend

    outputs = []
    for number in plt.get_fignums():
        file = io.BytesIO()
        plt.figure(number).savefig(file, format="png", dpi=_DPI, metadata={"Software": None})
        data = {"image/png": base64.b64encode(file.getvalue()).decode(), "text/plain": ["<Figure>"]}
        outputs.append({"data": data, "metadata": {}, "output_type": "display_data"})
    plt.close("all")
    return outputs


def main() -> None:
    """Write the outputs into the notebook."""
    mpl.use("Agg")
    os.chdir(NOTEBOOK.parent)
    notebook = executed(json.loads(NOTEBOOK.read_text(encoding="utf-8")))
    text = json.dumps(notebook, indent=1, ensure_ascii=False)
    NOTEBOOK.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
