"""Texts from a log made harmless for terminals, reports and shells, and lists of names."""

import re
import shlex
from collections.abc import Iterable, Sequence
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


def shell_quoted(word: str) -> str:
    """Return a word as a shell takes it, printable whatever it holds.

    Control characters stand in ``$'...'``, which bash, zsh and ksh understand.
    """
    if word.isprintable():
        return shlex.quote(word)
    return f"$'{''.join(map(_in_dollar_quotes, word))}'"


def _in_dollar_quotes(char: str) -> str:
    if char.isprintable():
        return f"\\{char}" if char in {"\\", "'"} else char
    return "".join(f"\\x{byte:02x}" for byte in char.encode("utf-8", "surrogateescape"))


def shell_joined(words: Iterable[str]) -> str:
    """Return a command that can be pasted into a shell; see `shell_quoted`."""
    return " ".join(map(shell_quoted, words))


def listed(names: Sequence[str], most: int = MOST) -> str:
    """Return ``a, b, c and 4 more``."""
    more = f" and {len(names) - most:,} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
