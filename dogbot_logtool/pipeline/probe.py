"""A quick look into a log: what a few of its chunks, spread over it, show.

Some decisions must be made before the first message is written: in which frame the wrenches are,
what the frames are called, whether the base has a parent already. They are made here, the same way
for every command.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.transform_buffer import TransformBuffer
from dogbot_logtool.core.frames.wrench_frame import (
    WrenchFrame,
    WrenchFrameEvidence,
    alignment,
    judge_wrench_frame,
)
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.finding import Finding, note, warning
from dogbot_logtool.pipeline.selection import Selection
from dogbot_logtool.reader.containers.log import Batch, Chunk, Log
from dogbot_logtool.reader.messages.contacts.registry import read_contacts
from dogbot_logtool.reader.messages.contacts.source import StepTiming
from dogbot_logtool.reader.messages.frame_tracks import static_tracks
from dogbot_logtool.reader.messages.odometry import (
    decode_odometry,
    odometry_frames,
)
from dogbot_logtool.reader.messages.transforms import (
    decode_transforms,
    frame_pairs,
    transform_columns,
)
from dogbot_logtool.robot import Robot

DEFAULT_WORLD: Final = "world"
DEFAULT_BASE: Final = "base_link"
_LOOKS: Final = 8
"""Chunks that are looked at, besides those with static transforms."""
_REGULAR: Final = 0.75
"""Share of messages that must have the usual lag. Only the last of each stance should not."""
_USUAL_INTERVAL_NS: Final = 10_000_000
"""Of a sensor that was hardly heard."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What was seen."""

    wrench_frame: WrenchFrameEvidence
    world_frames: tuple[str, ...]
    """Header frame ids of the odometry, as recorded, sorted; also `base_frames`, its children."""
    base_frames: tuple[str, ...]
    parents: Mapping[str, frozenset[str]]
    """Parents that the log's own transforms give each frame, without leading slashes."""
    statics: TransformBuffer
    """The log's transforms that hold for ever; of each frame the last one does."""
    slashed_frames: tuple[str, ...]
    """Frame ids that begin with a slash, which no viewer of today accepts."""
    links: tuple[str | None, ...]
    """Link that each foot's collision belongs to, in whose frame its wrenches may be."""
    intervals: Mapping[int, int]
    """ns between messages in contact, by foot, of the feet that are silent in swing."""
    left_after_ns: int | None
    """See `FootChannels.left_after_ns`."""
    touching: frozenset[int]
    """Feet that were seen in contact."""
    zero_stamps: frozenset[str]
    """Topics whose header stamps are all zero."""
    chunks_seen: int
    chunks: int


def look_into(log: Log, selection: Selection) -> Evidence:
    """Look into chunks from the start to the end of a log."""
    look = _Look(selection)
    chosen = _spread(log, selection)
    for span in log.grouped(chosen):
        look.take(log.read(span))
    return look.evidence(len(chosen), len(log.chunks))


def _spread(log: Log, selection: Selection) -> list[Chunk]:
    """Choose chunks: evenly spaced among those that hold used topics, and all static frames."""
    used = {c.id for c in (*selection.odometry, *selection.contacts, *selection.transforms)}
    static = selection.static_transforms
    useful = [c for c in log.chunks if c.counts is None or not used.isdisjoint(c.counts)]
    places = np.unique(np.linspace(0, max(len(useful) - 1, 0), _LOOKS).round().astype(int))
    chosen = {useful[place].offset for place in places.tolist() if useful}
    chosen |= {c.offset for c in useful if c.counts and not static.isdisjoint(c.counts)}
    return [chunk for chunk in useful if chunk.offset in chosen]


class _Look:
    def __init__(self, selection: Selection) -> None:
        self._selection = selection
        self._alignments: list[Floats] = []
        self._world: set[str] = set()
        self._base: set[str] = set()
        self._parents: dict[str, set[str]] = {}
        self._statics = TransformBuffer()
        self._slashed: set[str] = set()
        self._stamped: dict[str, bool] = {}
        self._links: dict[int, set[str]] = {}
        self._steps: dict[int, list[Ints]] = {}
        self._timings: list[StepTiming] = []
        self._touching: set[int] = set()

    def take(self, batch: Batch) -> None:
        """Look at the messages of a batch."""
        selection = self._selection
        for messages in decode_odometry(batch, selection.odometry):
            parents, children = odometry_frames(messages)
            self._world.update(parents)
            self._base.update(children)
            self._see_stamps(messages.channel, messages.table.nanoseconds("header.stamp"))
        for read in read_contacts(batch, selection.contacts, selection.foot_channels()):
            samples = read.felt.samples
            self._alignments.append(alignment(samples))
            self._timings.append(read.timing)
            self._touching.update(np.unique(samples.foot[samples.in_contact]).tolist())
            for foot, names in read.links.items():
                self._links.setdefault(foot, set()).update(names)
            if read.source.has_header:
                stamps = read.messages.table.nanoseconds("header.stamp")
                self._see_stamps(read.messages.channel, stamps)
            if read.source.silent_in_swing:
                for foot in np.unique(samples.foot).tolist():
                    steps = _steps(samples.log_time[samples.foot == foot], _begins(batch))
                    self._steps.setdefault(foot, []).append(steps)
        for messages in decode_transforms(batch, selection.transforms):
            for parent, child in frame_pairs(messages):
                self._slashed.update(name for name in (parent, child) if name.startswith("/"))
                self._parents.setdefault(child.lstrip("/"), set()).add(parent.lstrip("/"))
            if selection.static_transforms:
                tracks = static_tracks(transform_columns(messages), selection.static_transforms)
                self._statics = self._statics.then(tracks)

    def _see_stamps(self, channel: Ints, stamp: Ints) -> None:
        topics = {c.id: c.topic for c in (*self._selection.odometry, *self._selection.contacts)}
        for number in np.unique(channel).tolist():
            stamped = bool((stamp[channel == number] != 0).any())
            topic = topics[number]
            self._stamped[topic] = self._stamped.get(topic, False) or stamped

    def evidence(self, seen: int, chunks: int) -> Evidence:
        """Sum up."""
        alignments = np.concatenate([np.empty(0), *self._alignments])
        frames = self._world | self._base
        self._slashed.update(name for name in frames if name.startswith("/"))
        return Evidence(
            wrench_frame=self._wrench_frame(alignments),
            world_frames=tuple(sorted(self._world)),
            base_frames=tuple(sorted(self._base)),
            parents={child: frozenset(names) for child, names in sorted(self._parents.items())},
            statics=self._statics,
            slashed_frames=tuple(sorted(self._slashed)),
            links=tuple(
                next(iter(names)) if len(names := self._links.get(foot, set())) == 1 else None
                for foot in range(len(self._selection.robot.feet))
            ),
            intervals={foot: _interval(steps) for foot, steps in sorted(self._steps.items())},
            left_after_ns=left_after(self._timings),
            touching=frozenset(self._touching),
            zero_stamps=frozenset(topic for topic, stamped in self._stamped.items() if not stamped),
            chunks_seen=seen,
            chunks=chunks,
        )

    def _wrench_frame(self, alignments: Floats) -> WrenchFrameEvidence:
        """Decide by what the types of messages promise, else by evidence."""
        promised = {source.frame for source in self._selection.sources}
        (frame,) = promised if len(promised) == 1 else (None,)
        return judge_wrench_frame(alignments) if frame is None else WrenchFrameEvidence(frame)


def left_after(timings: list[StepTiming]) -> int | None:
    """Return the lag, ns, beyond which a foot has left the ground; None where that is not known.

    While a foot stands, each step has a contact. So the newest step of a message lies as far from
    its stamp as in any other, unless the foot left in between. Where lags vary for other reasons,
    as with a simulation that runs ahead of its sensors, a lag tells nothing.
    """
    lag = np.concatenate([np.empty(0, np.int64), *(timing.lag for timing in timings)])
    step = np.concatenate([np.empty(0, np.int64), *(timing.step for timing in timings)])
    if not len(step):
        return None
    usual, half_a_step = float(np.median(lag)), float(np.median(step)) / 2.0
    regular = np.abs(lag - usual) < half_a_step
    return round(usual + half_a_step) if regular.mean() >= _REGULAR else None


def _begins(batch: Batch) -> Ints:
    """(c,) ns, log time of the first message of each chunk, ascending."""
    first = [chunk.rows.start for chunk in batch.chunks if chunk.rows.start < chunk.rows.stop]
    return np.sort(batch.messages.log_time[first])


def _steps(log_time: Ints, begins: Ints) -> Ints:
    """Return the times, ns, from message to message within chunks: what lies between is unseen."""
    chunk = np.searchsorted(begins, log_time, side="right")
    steps = np.diff(log_time)
    seen: Ints = steps[(steps > 0) & (np.diff(chunk) == 0)]
    return seen


def _interval(steps: list[Ints]) -> int:
    """Return the median interval, ns."""
    known = np.concatenate(steps)
    return int(np.median(known)) if len(known) else _USUAL_INTERVAL_NS


def frame_names(robot: Robot, evidence: Evidence) -> tuple[str, str]:
    """Return the world's and the base's frame: the robot's, else the odometry's, else ROS'."""
    return (
        robot.world_frame or _frame(evidence.world_frames, DEFAULT_WORLD),
        robot.base_frame or _frame(evidence.base_frames, DEFAULT_BASE),
    )


def _frame(recorded: tuple[str, ...], default: str) -> str:
    names = [name.lstrip("/") for name in recorded if name.strip("/")]
    return names[0] if names else default


def evidence_findings(selection: Selection, evidence: Evidence) -> list[Finding]:
    """Return what a user should know of what was seen."""
    findings: list[Finding] = []
    if evidence.zero_stamps:
        used = {c.topic for c in (*selection.odometry, *selection.contacts)}
        everywhere = evidence.zero_stamps >= used
        topics = "everywhere" if everywhere else "on " + ", ".join(sorted(evidence.zero_stamps))
        text = f"header stamps are zero {topics}: log time is used instead"
        findings.append(warning("ZERO_STAMPS", text))
    if evidence.slashed_frames:
        frames = ", ".join(evidence.slashed_frames)
        text = f"frame ids begin with a slash, which viewers of today do not accept: {frames}"
        findings.append(warning("SLASHED_FRAMES", text))
    feet = range(len(selection.robot.feet))
    if any(selection.sources_of(foot) and selection.knows_force(foot) for foot in feet):
        findings.append(_wrench_frame_finding(evidence))
    if len(evidence.world_frames) > 1 or len(evidence.base_frames) > 1:
        frames = ", ".join((*evidence.world_frames, *evidence.base_frames))
        findings.append(warning("FRAMES_CHANGE", f"the odometry names several frames: {frames}"))
    return findings


def _wrench_frame_finding(evidence: Evidence) -> Finding:
    seen = evidence.wrench_frame
    if seen.frame is WrenchFrame.UNKNOWN:
        text = (
            f"the frame of the wrenches is not known ({seen.samples} loaded samples with normals "
            "were seen): only magnitudes are used; --wrench-frame says which"
        )
        return warning("WRENCH_FRAME_UNKNOWN", text)
    told = "(as their type promises)"
    if seen.median_alignment is not None:
        told = f"(median |F.n|/|F| is {seen.median_alignment:.3f} over {seen.samples} samples)"
    if seen.frame is WrenchFrame.WORLD:
        return note("WRENCH_FRAME_WORLD", f"wrenches are in the world frame {told}")
    return note(
        "WRENCH_FRAME_LINK",
        f"wrenches are not in the world frame but in a link's {told}",
    )
