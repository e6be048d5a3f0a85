"""What checks tell is what the sentences of their findings name."""

import ast
from collections.abc import Iterator
from string import Formatter

import pytest

from dogbot_logtool.finding import finding_kinds, found
from tests.paths import ROOT

CHECKS = ROOT / "dogbot_logtool" / "core" / "checks"


def calls() -> Iterator[tuple[str, ast.Call]]:
    """Each call of `found`, and where it stands."""
    for file in sorted(CHECKS.glob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
            is_of_findings = getattr(call.func, "id", "") in {"found", "_doubted"}
            if is_of_findings and all(each.arg for each in call.keywords):
                yield f"{file.stem}:{call.lineno}", call


def words(node: ast.AST) -> set[str]:
    constants = (each.value for each in ast.walk(node) if isinstance(each, ast.Constant))
    return {each for each in constants if isinstance(each, str)}


@pytest.mark.parametrize(("where", "call"), [*calls()])
def test_a_check_tells_what_its_sentence_names(where: str, call: ast.Call) -> None:
    told = {each.arg for each in call.keywords} - {"say", "feet"}
    told |= {"foot"} if any(each.arg == "feet" for each in call.keywords) else set()
    texts = {code: kind.texts for code, kind in finding_kinds().items()}
    named = {
        (code, name): {field for _, field, *_ in Formatter().parse(text) if field}
        for code in words(call) & texts.keys() or texts.keys()
        for name, text in texts[code].items()
    }
    assert any(fields <= told for fields in named.values()), (where, told, named)
    said = [each.value for each in call.keywords if each.arg == "say"]
    for key in named if said else ():
        assert key[1] not in words(said[0]) or named[key] <= told, (where, key)


def test_numbers_have_their_nouns() -> None:
    texts = [found("SPIKES", foot="left", spikes=number).text for number in (1, 2)]
    assert [text.split(" in ")[0] for text in texts] == ["1 lone spike", "2 lone spikes"]
