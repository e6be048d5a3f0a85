"""Recordings one after another: a walk, then a fall."""

from dataclasses import replace
from typing import TypeVar

import numpy as np

from tests.truth.recording import (
    BaseRecording,
    Floats,
    FootRecording,
    FootTruth,
    Recording,
    Truth,
    nanoseconds,
)

_Columns = TypeVar("_Columns", FootRecording, BaseRecording)


def then(first: Recording, second: Recording) -> Recording:
    """Let a recording follow another of the same robot, from where the base is.

    Both must be undisturbed. What is true of the first's gait stays true of the whole, and of the
    second its events; a foot that is down in one and up in the other lands or leaves between them.
    """
    step = first.base.time[1] - first.base.time[0]
    later = float(first.seconds + step)
    moved = first.base.position[-1] - second.base.position[0]
    moved[2] = 0.0
    pairs = list(zip(first.feet, second.feet, strict=True))
    truths = zip(first.truth.feet, second.truth.feet, strict=True)
    seconds = first.seconds, second.seconds
    feet = tuple(
        _joined_truth(*truth, *pair, later, seconds)
        for truth, pair in zip(truths, pairs, strict=True)
    )
    return replace(
        first,
        feet=tuple(_joined(*pair, later, moved) for pair in pairs),
        base=_joined(first.base, second.base, later, moved),
        truth=_joined_truths(first.truth, second.truth, feet, seconds, later),
        seconds=later + second.seconds,
    )


def _joined(first: _Columns, second: _Columns, later: float, moved: Floats) -> _Columns:
    """Let messages follow others, later and elsewhere."""
    stamp = nanoseconds(second.time + later)
    place = "point" if isinstance(second, FootRecording) else "position"
    changed = {
        "time": second.time + later,
        "stamp": stamp,
        "log_time": stamp + (second.log_time - second.stamp),
        place: getattr(second, place) + moved,
    }
    columns = type(first).__slots__
    return type(first)(
        *(
            np.concatenate([getattr(first, name), changed.get(name, getattr(second, name))])
            for name in columns
        )
    )


def _joined_truth(
    one: FootTruth,
    other: FootTruth,
    before: FootRecording,
    after: FootRecording,
    later: float,
    seconds: tuple[float, float],
) -> FootTruth:
    was, is_now = before.touching[-1], after.touching[0]
    lands = (later,) if is_now and not was else ()
    leaves = (later,) if was and not is_now else ()
    down = one.contact_fraction * seconds[0] + other.contact_fraction * seconds[1]
    return replace(
        one,
        touchdown_s=(*one.touchdown_s, *lands, *(each + later for each in other.touchdown_s)),
        lift_off_s=(*one.lift_off_s, *leaves, *(each + later for each in other.lift_off_s)),
        contact_fraction=down / sum(seconds),
    )


def _joined_truths(
    first: Truth,
    second: Truth,
    feet: tuple[FootTruth, ...],
    seconds: tuple[float, float],
    later: float,
) -> Truth:
    ways = [way for way in (first.path_length_m, second.path_length_m) if way is not None]
    way = first.forward_speed_mps * seconds[0] + second.forward_speed_mps * seconds[1]
    speed = way / (later + seconds[1])
    return replace(
        first,
        feet=feet,
        path_length_m=sum(ways) if len(ways) == 2 else None,
        height_m=None,
        impulse_over_weight=None,
        forward_speed_mps=speed,
        support=None,
        froude=None,
        climb_m=None,
        falls_s=first.falls_s + tuple(each + later for each in second.falls_s),
        seams_s=(*first.seams_s, later),
    )
