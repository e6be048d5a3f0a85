"""Texts from a log made harmless: nothing in them can upset a terminal or a report."""

import re
from typing import Final

_LAYOUT: Final = re.compile("([\n\t])")


def printable(text: str) -> str:
    """Return the text with control characters, line breaks included, as visible escapes."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def printable_lines(text: str) -> str:
    """Return the text with control characters as visible escapes; line breaks and tabs stay."""
    if text.replace("\n", "").replace("\t", "").isprintable():
        return text
    return "".join(
        each if each in {"\n", "\t"} else printable(each) for each in _LAYOUT.split(text)
    )
