"""The strings below the fields of records: what each field means, told once."""

import ast
import sys
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any


def definitions(record: Any) -> dict[str, str]:  # noqa: ANN401 - any record
    """Read the strings below the fields of a record, or of an enumeration, from the source."""
    found: dict[str, str] = {}
    package = record.__module__.partition(".")[0]
    for each in reversed(record.__mro__):
        if each.__module__.startswith(package):
            found |= _definitions_in(each.__module__).get(each.__name__, {})
    return found


@cache
def _definitions_in(module: str) -> dict[str, dict[str, str]]:
    source = Path(str(sys.modules[module].__file__)).read_text(encoding="utf-8")
    classes = (each for each in ast.parse(source).body if isinstance(each, ast.ClassDef))
    return {each.name: dict(_strings_below(each.body)) for each in classes}


def _strings_below(body: Sequence[ast.stmt]) -> Iterator[tuple[str, str]]:
    for line, below in pairwise(body):
        match line, below:
            case (
                ast.AnnAssign(target=ast.Name(id=name)) | ast.Assign(targets=[ast.Name(id=name)]),
                ast.Expr(value=ast.Constant(value=str(words))),
            ):
                yield name, " ".join(words.split())
