"""Texts from a log made harmless: nothing in them can upset a terminal or a report."""


def printable(text: str) -> str:
    """Return the text with control characters, line breaks included, as visible escapes."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
