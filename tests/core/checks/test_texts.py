"""What checks tell is what the sentences of their findings name."""

import ast
from collections.abc import Iterator
from string import Formatter

import pytest

from dogbot_logtool.finding import finding_kinds, found
from tests.paths import ROOT

CHECKS = ROOT / "dogbot_logtool" / "core" / "checks"


def calls() -> Iterator[tuple[str, ast.Call, set[str]]]:
    """Each call of `found`, where it stands, and the names of the values that it gives."""
    for file in sorted(CHECKS.glob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        for function in (each for each in tree.body if isinstance(each, ast.FunctionDef)):
            words: set[str] = set()
            for node in sorted(ast.walk(function), key=lambda each: getattr(each, "lineno", 0)):
                if isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(
                    node.value, ast.Dict
                ):
                    words = {key for each in node.value.keys if each for key in strings(each)}
                if getattr(getattr(node, "func", None), "id", "") in {"found", "_doubted"}:
                    assert isinstance(node, ast.Call)
                    gives = {each.arg for each in node.keywords if each.arg}
                    extra = words if len(gives) < len(node.keywords) else set()
                    if function.name != "_doubted":
                        yield f"{file.stem}:{node.lineno}", node, gives | extra


def strings(node: ast.AST) -> set[str]:
    constants = (each.value for each in ast.walk(node) if isinstance(each, ast.Constant))
    return {each for each in constants if isinstance(each, str)}


@pytest.mark.parametrize(("where", "call", "gives"), [*calls()])
def test_a_check_tells_what_its_sentence_names(where: str, call: ast.Call, gives: set[str]) -> None:
    told = gives - {"say", "feet"}
    told |= {"foot"} if "feet" in gives else set()
    texts = {code: kind.texts for code, kind in finding_kinds().items()}
    named = {
        (code, name): {field.split(".")[0] for _, field, *_ in Formatter().parse(text) if field}
        for code in strings(call) & texts.keys() or texts.keys()
        for name, text in texts[code].items()
    }
    assert any(fields <= told for fields in named.values()), (where, told, named)
    said = [each.value for each in call.keywords if each.arg == "say"]
    for key in named if said else ():
        assert key[1] not in strings(said[0]) or named[key] <= told, (where, key)


def test_numbers_have_their_nouns() -> None:
    texts = [found("SPIKES", foot="left", spikes=number).text for number in (1, 2)]
    assert [text.split(" in ")[0] for text in texts] == ["1 lone spike", "2 lone spikes"]
