"""What is said on stderr: errors, damage, notes."""

from typing import Final

from dogbot_logtool.io.printable import listed, printable
from dogbot_logtool.io.storage import valid_unicode, without_secrets

NEW_LINE: Final = "\n  "
"""Begins a line of a list in an error's sentence; names from logs cannot begin lines of ours."""


def say(sentence: str) -> None:
    """Print the sentence of an error; what it lists stands in indented lines below."""
    from dogbot_logtool.report.text.console import diagnostics, print_command, print_sentence  # noqa: PLC0415

    first, *others = map(printable, without_secrets(sentence).split(NEW_LINE))
    label = "error: "
    print_sentence(diagnostics(), (label, "red"), first, indent=len(label))
    for line in others:
        if line.startswith("dogbot-logtool "):
            print_command(diagnostics(), line, 2)
        else:
            print_sentence(diagnostics(), f"  {line}", indent=4)


def say_damage(sentence: str) -> None:
    """Print what was lost of a log: one line, whatever the names in it."""
    from dogbot_logtool.report.text.console import diagnostics, print_sentence  # noqa: PLC0415

    text = printable(without_secrets(valid_unicode(sentence)))
    print_sentence(diagnostics(), ("damage: ", "red"), text)


def say_failures(failures: list[tuple[str, str]], logs: int) -> None:
    """Print the logs that could not be done; those of one cause share a line.

    Args:
        failures: names and sentences.
        logs: how many there were in all.
    """
    from dogbot_logtool.report.text.console import diagnostics, print_sentence  # noqa: PLC0415

    say(f"{len(failures)} of {logs} logs could not be done")
    names: dict[str, list[str]] = {}
    for name, sentence in failures:
        first, *_ = sentence.removeprefix(f"{name}: ").split(NEW_LINE)
        names.setdefault(first, []).append(name)
    labels = {first: printable(listed(each)) for first, each in names.items()}
    width = min(max(map(len, labels.values())), 60)
    for first, label in labels.items():
        print_sentence(diagnostics(), f"  {label:<{width}}  {printable(first)}", indent=4)


def note(sentence: str) -> None:
    """Print what is good to know."""
    from dogbot_logtool.report.text.console import diagnostics, print_note  # noqa: PLC0415

    print_note(diagnostics(), sentence)
