"""Whether two runs, or two groups of runs, can be compared at all."""

from collections.abc import Iterator, Mapping, Sequence
from statistics import median
from typing import Any, Final

from dogbot_logtool.comparison.walks.two_runs import FEWEST_STRIDES

MOST_SPEED_SHARE: Final = 0.2
"""Share by which speeds may differ: stance and stride follow the speed."""
MOST_SPEED_MPS: Final = 0.05
"""m/s, by which they may differ however slow the robot is."""
MOST_MASS_SHARE: Final = 0.01

Json = Mapping[str, Any]


def why_not_comparable(first: Sequence[Json], second: Sequence[Json]) -> list[str]:
    """Say what keeps two sides from being compared, a sentence each; empty if nothing does.

    Args:
        first: ``stats --json`` of the runs of one side.
        second: of the other.
    """
    checks = (_feet, _gait, _speed, _mass)
    return [reason for check in checks for reason in check(first, second)]


def doubts(documents: Sequence[Json]) -> Iterator[str]:
    """Yield which recordings are not to be relied on."""
    for document in documents:
        checks = document["quality"]["checks"]
        failed = [each["name"] for each in checks if each["outcome"] == "failed"]
        if failed:
            yield f"{document['log']['path']}: {', '.join(failed)} does not hold"


def _feet(first: Sequence[Json], second: Sequence[Json]) -> Iterator[str]:
    names = [{frozenset(document["feet"]) for document in side} for side in (first, second)]
    if len(names[0] | names[1]) > 1:
        yield "the robots have different feet"
    for number, side in enumerate((first, second), 1):
        strides = sum(
            foot["strides"] or 0 for document in side for foot in document["feet"].values()
        )
        feet = len(set().union(*(document["feet"] for document in side)))
        if strides < FEWEST_STRIDES * max(feet, 1):
            yield f"side {number} has {strides} strides of {feet} feet: too few"


def _gait(first: Sequence[Json], second: Sequence[Json]) -> Iterator[str]:
    classes = [{document["gait"]["name"] for document in side} for side in (first, second)]
    if classes[0] != classes[1] or len(classes[0]) > 1:
        yield f"the gaits differ: {_listed(classes[0])} against {_listed(classes[1])}"


def _listed(classes: set[str | None]) -> str:
    return ", ".join(sorted(each or "not known" for each in classes))


def _speed(first: Sequence[Json], second: Sequence[Json]) -> Iterator[str]:
    speeds = [[d["base"]["forward_speed_mps"] for d in side] for side in (first, second)]
    known = [[each for each in side if each is not None] for side in speeds]
    if not all(known):
        return
    one, other = (median(side) for side in known)
    if abs(one - other) > max(MOST_SPEED_MPS, MOST_SPEED_SHARE * max(abs(one), abs(other))):
        yield f"the speeds differ: {one:.2f} m/s against {other:.2f} m/s"


def _mass(first: Sequence[Json], second: Sequence[Json]) -> Iterator[str]:
    masses = {document["settings"]["mass_kg"] for document in (*first, *second)}
    known = [mass for mass in masses if mass is not None]
    apart = known and max(known) - min(known) > MOST_MASS_SHARE * max(known)
    if apart or 0 < len(known) < len(masses):
        yield f"the masses differ: {', '.join(f'{mass:g} kg' for mass in sorted(known))}"
