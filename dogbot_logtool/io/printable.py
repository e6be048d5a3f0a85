"""Texts from a log made harmless for terminals and reports, and lists of names in sentences."""

import re
from collections.abc import Sequence
from typing import Final

_LAYOUT: Final = re.compile("([\n\t])")

MOST: Final = 10


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


def listed(names: Sequence[str], most: int = MOST) -> str:
    """Return ``a, b, c and 4 more``."""
    more = f" and {len(names) - most:,} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
