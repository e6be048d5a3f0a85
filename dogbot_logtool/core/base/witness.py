"""The base's motion by the feet alone, or by the twist, and poses against it, stride by stride.

Contact points in the world rest while the base moves on. From footfall to footfall a foot goes as
far as the base, so that the centroid of all feet goes where the base goes, and their directions
from it turn as it turns. Places of feet in the base's axes tell its velocity (`leg_odometry`).
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Complexes,
    Flags,
    Floats,
    Ints,
    all_finite,
    distinct,
    interpolated,
    median_of,
    median_of_known,
    middles,
    norms,
)
from dogbot_logtool.core.base.ground import RATE_HZ, FootPath, contact_path, footfalls
from dogbot_logtool.core.base.leg_odometry import dead_reckoned, leg_odometry
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.clock import first_at_each_tick
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import Cut
from dogbot_logtool.core.rotations import from_roll_pitch_yaw, rotate
from dogbot_logtool.core.settings import LegPosition

TICK_NS: Final = 50_000_000
"""ns, how often feet that rest in the world are looked at."""
FEWEST_FOOTFALLS: Final = 3
"""Footfalls of a foot that tell of the base's motion."""
UNSURE: Final = 0.3
"""Share of its usual speed by which standing feet disagree from which they do not tell it."""
UNSURE_MPS: Final = 0.1
"""m/s, the same of a base that hardly moves."""
_SPREAD_M: Final = 0.05
"""m between feet from which their directions tell a turn."""
RESTS_M: Final = 0.01
"""m that places of feet in the body move at most while no leg steps."""
POINTS: Final = "contact points"
LEGS: Final = "legs"
TWIST: Final = "the twist beside them"


class Witness(NamedTuple):
    """The base's motion by something else than its poses."""

    poses: BaseHistory
    """From any origin; by `POINTS`, the heading is that of the robot's forward axis."""
    by: str
    """`POINTS`, `LEGS` or `TWIST`."""
    tells_heading: bool
    """Whether the heading is the robot's own, and not only its changes are known."""
    tells_turn: bool
    """Whether the heading turns as the feet do."""
    rests: bool = False
    """Whether no foot's place moves in the body: it stands, or these are no feet's places."""
    leg_m: float = 0.0
    """By `LEGS`, how far feet usually are from the base's origin."""

    def motion(self, windows: Ints, forward_rad: float) -> "Motion":
        """Return the motion along the robot's forward axis in some windows; see `motion_in`."""
        return motion_in(self.poses, windows, 0.0 if self.by == POINTS else forward_rad)

    def stand_in(self, recorded: BaseHistory, forward_rad: float) -> BaseHistory | None:
        """Return poses of the base in place of recorded ones, of which none can be used.

        Args:
            recorded: no poses.
            forward_rad: from the body's x axis to the axis that points forward.

        Returns:
            None where heading or turn are not known.
        """
        if len(recorded.time) or not (self.tells_heading and self.tells_turn):
            return None
        ahead = forward_rad if self.by == POINTS else 0.0
        return replace(
            recorded,
            time=self.poses.time,
            position=self.poses.position,
            angles=self.poses.angles - np.array([0.0, 0.0, ahead]),
            gaps=self.poses.gaps,
            interval_s=0.0,
        )


def by_points(
    feet: Sequence[FootHistory], positions: Sequence[LegPosition | None]
) -> Witness | None:
    """Return the base's motion by contact points in the world.

    Args:
        feet: histories of feet whose contact points the recorded poses did not place.
        positions: of each foot on the body.

    Returns:
        None where no foot's points are known over three footfalls.
    """
    tracks = [_footfalls(foot) for foot in feet]
    used = [row for row, (time, _) in enumerate(tracks) if len(time) >= FEWEST_FOOTFALLS]
    if not used:
        return None
    start = max(int(tracks[row][0][0]) for row in used)
    end = min(int(tracks[row][0][-1]) for row in used)
    # Of a clock that was set by years only the time in which feet are known has ticks.
    spans = [np.array([[start, max(end, start)]]), *(feet[row].known for row in used)]
    time = timespans.ticks(timespans.intersect(spans), TICK_NS)
    if len(time) < FEWEST_FOOTFALLS:
        return None
    # (t, f, 3) m, where each foot's point is.
    places = np.stack([interpolated(time, *tracks[row]) for row in used], axis=1)
    centre = places.mean(axis=1)
    away = places - centre[:, None, :]
    turns = len(used) > 1 and float(median_of(np.abs(away[:, :, :2]).max(axis=1))) > _SPREAD_M
    angles = np.zeros((len(time), 3))
    heading = None
    if turns:
        flat = away[:, :, 0] + 1j * away[:, :, 1]
        angles[:, 2] = np.unwrap(np.angle((flat * flat[:1].conj()).sum(axis=1)))
        unturned = flat * np.exp(-1j * angles[:, 2])[:, None]
        heading = _heading(unturned.mean(axis=0), [positions[row] for row in used])
        angles[:, 2] += heading or 0.0
    poses = BaseHistory(time, centre, angles)
    return Witness(poses, POINTS, heading is not None, turns)


def _footfalls(foot: FootHistory) -> tuple[Ints, Floats]:
    """Return when and where a foot rests: in the middle of each stance."""
    place, stances = footfalls(contact_path(foot), foot.stances).position, foot.stances
    begin, end, known = stances.touchdown, stances.liftoff, all_finite(place)
    if stances.whole.any():
        # A stance that the log's start or end cuts is taken to be as long as others.
        usual = int(median_of((end - begin)[stances.whole]))
        begin = np.where(stances.cut == Cut.LOG_START, np.minimum(begin, end - usual), begin)
        end = np.where(stances.cut == Cut.LOG_END, np.maximum(end, begin + usual), end)
    return (begin + (end - begin) // 2)[known], place[known]


def _heading(places: Complexes, positions: Sequence[LegPosition | None]) -> float | None:
    """Return the direction of forward by where fore and hind, left and right feet are, rad.

    Args:
        places: (f,) m, x + iy of each foot, from the centre of all.
        positions: of each foot on the body.

    Returns:
        None where the names of the feet do not tell.
    """
    turns = {"front": 1.0, "back": -1.0, "left": -1.0j, "right": 1.0j}
    weights = [sum(turns.get(word, 0.0) for word in position or ()) for position in positions]
    ahead = complex(np.dot(places, weights))
    return float(np.angle(ahead)) if abs(ahead) > _SPREAD_M else None


def by_legs(
    places: Sequence[FootPath | None], feet: Sequence[FootHistory], base: BaseHistory
) -> Witness | None:
    """Return the base's motion by the feet's places in its own axes.

    Args:
        places: of each foot, from the base's origin along its axes; None: not known.
        feet: histories of the same feet.
        base: recorded poses, whose lean turns places into level axes.

    Returns:
        None where no foot's places are known.
    """
    pairs = zip(places, feet, strict=True)
    known = [(path, foot) for path, foot in pairs if path is not None and len(path.time) > 2]
    if not known:
        return None
    paths = [path for path, _ in known]
    # Some messages tell the place of a foot only while it stands.
    time = distinct(np.concatenate([path.time for path in paths]))
    time = time[first_at_each_tick(time, RATE_HZ)]
    place = np.stack([path.at(time) for path in paths], axis=1)
    standing = np.stack([timespans.covers(foot.in_contact, time) for _, foot in known], axis=1)
    if len(base.time):
        angles = interpolated(time, base.time, base.angles)
        # Two feet tell no turn about the line between them, and bases that bound lean in time.
        lean = from_roll_pitch_yaw(angles * [1.0, 1.0, 0.0])
        place = np.stack([rotate(lean, place[:, row]) for row in range(len(paths))], axis=1)
    legs = leg_odometry(time, place, standing)
    tells_turn = bool(np.isfinite(legs.turn_rate[:, 2]).mean() > 0.5)
    speed = norms(legs.velocity[np.isfinite(legs.velocity[:, 0])])
    if not len(speed) or legs.noise_mps > max(UNSURE_MPS, UNSURE * float(median_of(speed))):
        return None
    rests = max(float(np.ptp(path.position, axis=0).max()) for path in paths) < RESTS_M
    return Witness(
        dead_reckoned(legs),
        LEGS,
        tells_heading=True,
        tells_turn=tells_turn,
        rests=rests,
        leg_m=float(median_of_known(norms(place.reshape(-1, 3)), axis=0)),
    )


SHORTEST_STRIDES: Final = 1.5
"""Strides that one pose must last for."""
FEWEST_TOUCHDOWNS: Final = 2
STAYS_MPS: Final = 0.02
"""m/s: feet that walk on less quickly stay where they are."""
STAYS_RADPS: Final = 0.03
"""rad/s, the same of a turn."""


def find_frozen(
    base: BaseHistory, feet: Sequence[FootHistory], witness: Witness | None, period_s: float | None
) -> Ints:
    """Find the time in which one pose is repeated although the robot walks, or may walk, on.

    Args:
        base: poses as recorded.
        feet: histories of all feet.
        witness: the base's motion by its feet; None: not known.
        period_s: s, the usual stride; None: there is none.

    Returns:
        (s, 2) ns.
    """
    if not period_s or len(base.time) < 2:
        return timespans.no_spans()
    poses = np.column_stack([base.position, base.angles])
    spans: Ints = timespans.spans_where(base.time, (np.diff(poses, axis=0) == 0.0).all(axis=1))
    spans = spans[spans[:, 1] - spans[:, 0] >= SHORTEST_STRIDES * period_s * 1e9]
    steps = [np.diff(np.searchsorted(foot.stances.touchdown, spans))[:, 0] for foot in feet]
    most = np.reshape(steps, (len(feet), len(spans))).max(axis=0, initial=0)
    spans = spans[most >= FEWEST_TOUCHDOWNS]
    if witness is None or not len(spans):
        return spans
    motion = witness.motion(stride_windows(spans, period_s), 0.0)
    speeds, turns = np.abs(motion.displacement) / period_s, np.abs(motion.turn) / period_s
    stays = float(median_of_known(speeds, axis=0)) < STAYS_MPS
    stays &= float(median_of_known(turns, axis=0)) < STAYS_RADPS
    return timespans.no_spans() if stays else spans


def without_frozen(base: BaseHistory, spans: Ints) -> BaseHistory:
    """Return poses without those of some spans, (s, 2) ns, which become gaps."""
    inside = timespans.covers(spans, base.time - 1) | timespans.covers(spans, base.time)
    rows = np.flatnonzero(~inside)
    return base.pick(rows) if len(rows) > 1 else base.without_poses()


FEWEST_STRIDES: Final = 2
SHORTEST_PATH_M: Final = 0.2
"""m in all that a witness must tell, for a way to be compared."""
SHORTEST_STEP: Final = 0.1
"""Share of a leg that legs go in a stride, at least, if they are to judge poses."""
COHERENT: Final = 0.7
"""Coherence |sum a conj(b)| / sqrt(sum |a|^2 sum |b|^2) from which a way is another one turned."""
SWINGS: Final = 0.3
"""m a radian: a way that is shorter than a turn times this may be that of a point off the base."""


class Motion(NamedTuple):
    """How far a base moves in each of k windows; NaN where that is not known."""

    displacement: Complexes
    """(k,) m, ahead + i x to the left, along its own heading."""
    turn: Floats
    """(k,) rad."""
    rise: Floats
    """(k,) m."""

    @property
    def walked_m(self) -> float:
        """The sum of all distances, m."""
        return float(np.abs(self.displacement).sum())

    def pick(self, rows: Flags) -> "Motion":
        """Return the chosen windows."""
        return Motion(self.displacement[rows], self.turn[rows], self.rise[rows])


def stride_windows(strides: Ints, period_s: float) -> Ints:
    """Return spans, each as long as the usual stride, one after another while a robot walks.

    Args:
        strides: (s, 2) ns, merged spans with strides.
        period_s: s, the usual stride.
    """
    period = round(period_s * 1e9)
    starts = [
        np.arange(start, end - period + 1, period, dtype=np.int64)
        for start, end in strides.tolist()
    ]
    first = np.concatenate([np.empty(0, np.int64), *starts])
    return np.stack([first, first + period], axis=1)


def motion_in(base: BaseHistory, windows: Ints, forward_rad: float = 0.0) -> Motion:
    """Add up a base's steps in some windows.

    Args:
        base: poses, at least two.
        windows: (k, 2) ns.
        forward_rad: from the heading of its poses to forward.
    """
    ahead, left, _ = base.steps(forward_rad)
    path = np.concatenate([[0.0], np.cumsum(ahead + 1j * left)])
    outside = (windows[:, 0] < base.time[0]) | (windows[:, 1] > base.time[-1])
    outside |= timespans.touches(base.gaps, windows[:, 0], windows[:, 1])
    columns = np.column_stack([path.real, path.imag, base.angles[:, 2], base.position[:, 2]])
    changes = np.diff(interpolated(windows, base.time, columns), axis=1)[:, 0]
    changes[outside] = np.nan
    return Motion(changes[:, 0] + 1j * changes[:, 1], changes[:, 2], changes[:, 3])


class Comparison(NamedTuple):
    """The motion by poses against that by a witness, over whole strides that both tell of."""

    by: str
    """The witness."""
    own: Motion
    """By the poses; `reference`, by the witness."""
    reference: Motion
    tells_heading: bool
    """Whether the witness tells directions."""
    leg_m: float
    """As the witness has it."""

    @property
    def strides(self) -> int:
        """The strides that are compared."""
        return len(self.own.turn)

    @property
    def goes_m(self) -> float:
        """How far the witness goes, or poses beside legs that stay, if half of that is more, m."""
        # A twist of zeros was not filled in.
        beside = self.own.walked_m / 2.0 if self.by == LEGS else 0.0
        return max(self.reference.walked_m, beside)

    @property
    def goes(self) -> bool:
        """Whether they go somewhere."""
        return self.goes_m > SHORTEST_PATH_M

    @property
    def is_short(self) -> bool:
        """Whether legs go so short a way a stride that feet may slip most of it."""
        return self.goes_m <= SHORTEST_STEP * self.leg_m * self.strides

    @property
    def tells_way(self) -> bool:
        """Whether they go far enough to be compared, and do not turn on the spot."""
        turns = self.goes_m <= SWINGS * float(np.abs(self.reference.turn).sum())
        return self.goes and not (self.is_short or turns)

    @property
    def scale(self) -> float:
        """How many times as far as the witness the poses go."""
        return self.own.walked_m / max(self.reference.walked_m, 1e-9)

    @property
    def direction_rad(self) -> float:
        """From the witness's way to that of the poses, to the left; 0 where it does not tell."""
        own, reference = self.own.displacement, self.reference.displacement
        product = complex(np.vdot(reference, own))
        coherent = abs(product) >= COHERENT * np.linalg.norm(own) * np.linalg.norm(reference)
        return float(np.angle(product)) if self.tells_heading and coherent else 0.0


def compare(
    witness: Witness | None, own: Motion, windows: Ints, forward_rad: float
) -> Comparison | None:
    """Compare the motion by poses with that by a witness, if there is one.

    Args:
        witness: of the same motion.
        own: the motion by poses in some windows.
        windows: (k, 2) ns.
        forward_rad: from the body's x axis to the axis that points forward.

    Returns:
        None where both tell of too few strides, or feet whose places rest do not tell.
    """
    if witness is None or witness.rests:
        return None
    reference = witness.motion(windows, forward_rad)
    both = np.isfinite(own.turn) & np.isfinite(reference.turn)
    if both.sum() < FEWEST_STRIDES:
        return None
    motions = own.pick(both), reference.pick(both)
    return Comparison(witness.by, *motions, witness.tells_heading, witness.leg_m)


def by_twist(poses: BaseHistory) -> Witness | None:
    """Return the base's motion as the twist beside its poses has it; None: there is none.

    Sources give it in the world's or in the body's axes: those count that are nearer to the way.
    """
    if len(poses.velocity) != len(poses.time) or not poses.velocity.any():
        return None
    velocity = np.where(all_finite(poses.velocity)[:, None], poses.velocity, 0.0)
    step = middles(velocity) * (np.diff(poses.time)[:, None] / 1e9)
    step = step[:, 0] + 1j * step[:, 1]
    own = np.diff(poses.position[:, 0] + 1j * poses.position[:, 1])
    turned = step * np.exp(1j * middles(poses.angles[:, 2]))
    nearer = min(step, turned, key=lambda each: float(np.abs(each - own).sum()))
    at = np.concatenate([[0.0], np.cumsum(nearer)])
    position = np.stack([at.real, at.imag, np.zeros(len(at))], axis=1)
    return Witness(replace(poses, position=position), TWIST, tells_heading=True, tells_turn=False)
