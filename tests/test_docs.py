"""The pages that are made of the program's tables are up to date, and the tables complete."""

import re

from pages import findings_page

from dogbot_logtool.finding import finding_kinds
from tests.paths import ROOT

_CODE = re.compile(r'"([EWN]_[A-Z_]+)"')
_CALL = re.compile(r'\b(error|warning|note)\(\s*"([A-Z_]+)"')
_LETTERS = {"error": "E", "warning": "W", "note": "N"}


def codes_in_the_code() -> set[str]:
    texts = [file.read_text(encoding="utf-8") for file in (ROOT / "dogbot_logtool").rglob("*.py")]
    whole = {code for text in texts for code in _CODE.findall(text)}
    calls = {f"{_LETTERS[name]}_{code}" for text in texts for name, code in _CALL.findall(text)}
    return whole | calls


def test_the_page_of_findings_is_up_to_date() -> None:
    page = (ROOT / "docs" / "findings.md").read_text(encoding="utf-8")
    assert page == findings_page(), "run: make docs"


def test_every_code_is_declared() -> None:
    codes = codes_in_the_code()
    assert len(codes) > 80
    assert codes - finding_kinds().keys() == set()


def test_every_declared_code_is_used() -> None:
    names = {code[2:] for code in finding_kinds()}
    texts = [file.read_text(encoding="utf-8") for file in (ROOT / "dogbot_logtool").rglob("*.py")]
    unused = {name for name in names if not any(name in text for text in texts)}
    assert unused == set()
