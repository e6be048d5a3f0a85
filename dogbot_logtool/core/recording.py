"""A whole log as columns: all that is measured is computed from these."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import AnyColumns, Flags, Floats, Ints, all_finite
from dogbot_logtool.core.base.poses import Odometry, no_odometry
from dogbot_logtool.core.clock import Stamped
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.transforms import Edge, Transforms


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Times:
    """Times of a topic's messages, in the order of their log times."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints | None
    """(n,) ns, header stamps as recorded; None for messages without a header, or of no use."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class VectorSamples:
    """Vectors that messages of one topic hold, in the order of the log."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns, header stamp as recorded; 0: none."""
    vector: Floats
    """(n, 3), as recorded."""
    turn_rate: Floats
    """(n, 3) rad/s, of an inertial unit; NaN: not recorded."""


class VectorTopic(NamedTuple):
    """Vectors of one topic: velocity commands, or accelerations."""

    samples: VectorSamples
    frames: tuple[str, ...]
    """Header frame ids among them, sorted."""


MOST_JOINTS: Final = 256
"""Joints of a robot that are followed; no robot with legs has more."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class JointSamples:
    """States of k joints, one row a message."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns; the log time of messages without a stamp."""
    position: Floats
    """(n, k) rad or m; also `velocity`, rad/s or m/s, and `effort`, N m or N; NaN: not told."""
    velocity: Floats
    effort: Floats


class JointTable(NamedTuple):
    """Joint states of a topic, in the order of the log."""

    topic: str
    names: tuple[str, ...]
    """Names of the joints in `samples`."""
    samples: JointSamples

    @property
    def seconds(self) -> Floats:
        """(n,) s since the first, by stamps."""
        return np.asarray((self.samples.stamp - self.samples.stamp[0]) / 1e9)

    def of(self, names: Sequence[str]) -> JointSamples:
        """Return the states of some joints, in this order."""
        columns, all_of = [self.names.index(name) for name in names], self.samples
        values = (each[:, columns] for each in (all_of.position, all_of.velocity, all_of.effort))
        return JointSamples(all_of.log_time, all_of.stamp, *values)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Recording:
    """Everything that was recorded of the base, feet, joints and frames, by log time."""

    feet: tuple[Samples, ...] = ()
    """Contact samples of each foot, as recorded."""
    planned: tuple[Samples, ...] = ()
    """The same as a plan in the log has them."""
    links: Mapping[int, frozenset[str]] = field(default_factory=dict)
    """Links that the collisions of each foot belong to, in whose frames its forces may be."""
    base: Odometry = field(default_factory=no_odometry)
    """Poses of the base, also those that cannot be used."""
    world_frames: tuple[str, ...] = ()
    """Frames that these poses are in, as recorded, sorted; also `base_frames`, what they place."""
    base_frames: tuple[str, ...] = ()
    transforms: Mapping[Edge, Transforms] = field(default_factory=dict)
    """The log's own transforms, by parent and child."""
    slashed_frames: frozenset[str] = frozenset()
    """Frame ids among these that begin with a slash, as recorded."""
    joints: tuple[JointTable, ...] = ()
    """Joint states, the best topic first."""
    commands: VectorTopic | None = None
    """Velocity commands; None: the log has none. Likewise `accelerations` of the base."""
    accelerations: VectorTopic | None = None
    topics: Mapping[str, Times] = field(default_factory=dict)
    """Times of every topic's messages."""
    implausible: int = 0
    """Poses and contact samples with numbers that no robot reaches; those are NaN."""
    untimed_messages: int = 0
    """Contact messages of several states without the time of their physics step."""
    foreign_states: int = 0
    """Contact states between other bodies than the foot."""
    out_of_order: int = 0
    """Messages that stand behind later ones of their channel in the file."""


def has_own_stamps(columns: Stamped) -> bool:
    """Tell whether messages have stamps, and not only the log times that stand in for them."""
    return bool(columns.stamp.any() and (columns.stamp != columns.log_time).any())


LARGEST: Final = 1e9
"""m, m/s, rad/s or N: beyond the moon, faster than light, stronger than any rocket."""
_BOUNDED: Final = ("position", "translation", "linear_velocity", "force")


def _beyond(vectors: Floats) -> Flags:
    """(n,) which rows of (n, k) are finite but have a number beyond the bound."""
    if not len(vectors) or (vectors.min() >= -LARGEST and vectors.max() <= LARGEST):
        return np.zeros(len(vectors), np.bool_)
    return np.asarray((np.abs(vectors) > LARGEST).any(axis=1)) & all_finite(vectors)


def plausible(columns: AnyColumns) -> tuple[AnyColumns, int]:
    """Take poses, forces and places that no robot reaches for NaN; count the rows with one.

    The bound is low enough that no metric made of numbers within it overflows.
    """
    own: Any = columns
    far = {name: _beyond(getattr(own, name)) for name in _BOUNDED if hasattr(own, name)}
    changes = {
        name: np.where(rows[:, None], np.nan, getattr(own, name))
        for name, rows in far.items()
        if rows.any()
    }
    if not changes:
        return columns, 0
    return replace(own, **changes), int(np.any(list(far.values()), axis=0).sum())
