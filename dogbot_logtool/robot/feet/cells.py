"""Several sensors in each foot: no single one tells the foot's load, and none is offered as it."""

from collections.abc import Iterator, Sequence
from typing import Final

from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.feet.candidates import FootCandidates, word_of
from dogbot_logtool.robot.feet.words import ENDS, SIDES, words_of

_PLACES: Final = frozenset(
    {*ENDS, *SIDES, "heel", "inner", "inside", "lateral", "medial", "outer", "outside", "toe"}
)
"""Words, beside numbers, that tell apart the sensors in a sole."""


def split_cells(found: Sequence[FootCandidates]) -> tuple[list[FootCandidates], list[Finding]]:
    """Leave out fields of which each foot has several, alike but for their place in it.

    Args:
        found: fields that may be feet, see `find_candidates`.

    Returns:
        the other fields, and a finding for each group that was left out.
    """
    groups: dict[tuple[object, ...], list[FootCandidates]] = {}
    for one in found:
        feet = tuple((foot.name, foot.topic, _without_place(foot)) for foot in one.feet)
        groups.setdefault((one.type_name, feet), []).append(one)
    cells = [group for group in groups.values() if len(group) > 1]
    left_out = {id(one) for group in cells for one in group}
    others = [one for one in found if id(one) not in left_out]
    return others, [_finding(group) for group in cells]


def _without_place(foot: Foot) -> tuple[str, ...]:
    """Return the words of a foot's field that do not tell where in the foot it is."""
    words = [word.text for word in words_of(foot.field.path if foot.field else "")]
    return tuple(word for word in words if word not in _PLACES and not word.isdigit())


def _finding(group: Sequence[FootCandidates]) -> Finding:
    feet = listed(list(_feet(group)))
    text = (
        f"fields of {group[0].type_name} look like several sensors in each foot: {feet}; a single "
        "one tells neither the load nor the contact of its foot, and fields cannot be added up "
        "here: record the sum of each foot's sensors on a topic of its own, such as "
        "/foot/left of geometry_msgs/WrenchStamped"
    )
    return Finding("FEET_UNSURE", text, cases=("possible",))


def _feet(group: Sequence[FootCandidates]) -> Iterator[str]:
    for number, foot in enumerate(group[0].feet):
        fields = dict.fromkeys(word_of(each.feet[number]) for each in group)
        yield f"{foot.name} = {' + '.join(fields)}"
