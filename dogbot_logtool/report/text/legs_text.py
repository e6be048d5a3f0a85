"""The legs in the figures for people."""

from collections.abc import Iterator

from dogbot_logtool.core.metrics import Legs
from dogbot_logtool.report.numbers import decimal


def work_words(legs: Legs) -> Iterator[tuple[str, str]]:
    """Yield names and values of what all legs do together, as far as it is known."""
    done, positive = legs.absolute_work_j, legs.positive_work_j
    if done is not None:
        known = "?" if positive is None else f"{decimal(positive.median, 2)} J"
        words = f"{decimal(done.median, 2)} J, {known} of it positive"
        yield "work of all joints in a stride", words
    cost = legs.mechanical_cost_of_transport
    if cost is not None:
        yield "mechanical cost of transport", f"{decimal(cost, 3)}  (|work| / weight x way)"
