"""The log's own frames: link-frame forces turned into the world, positions of sensors."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Protocol

import numpy as np

from dogbot_logtool.core.base.poses import Odometry, usable_poses
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import (
    Poses,
    RecordedTransforms,
    TransformBuffer,
    chain_of_frames,
    frame_track,
    moving_tracks,
)
from dogbot_logtool.core.frames.wrench_frame import FramePoint, place_points, turn_forces
from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.finding import Finding
from dogbot_logtool.robot.names import name_feet
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.words import Part


class RecordedFrames(Protocol):
    """Facts about frames from a log's transforms; a `Probe` is one."""

    @property
    def parents(self) -> Mapping[str, frozenset[str]]:
        """Parents that the transforms give each frame."""

    @property
    def statics(self) -> TransformBuffer:
        """Transforms that hold for ever."""

    @property
    def links(self) -> tuple[str | None, ...]:
        """Link of each foot, in whose frame its wrenches may be."""


@dataclass(frozen=True, slots=True)
class WorldFrames:
    """How frames of feet hang in the world, decided before the first message is read."""

    links: tuple[str | None, ...]
    """Frame of each foot's forces; None: not to be turned, or not connected to the world."""
    points: tuple[FramePoint | None, ...]
    """Place of each foot's sensor; None: it tells contact points, or is not connected."""
    world: str
    base: str
    odometry_places_base: bool
    moving: Mapping[str, str]
    """Parents of the frames on the way to the world that the log's own transforms move."""
    statics: TransformBuffer
    clock: TimeSource

    def tracks(self, transforms: RecordedTransforms, poses: Odometry) -> TransformBuffer:
        """Return what transforms and poses tell of the frames that are needed."""
        tracks = TransformBuffer()
        if self.odometry_places_base:
            poses = poses.pick(usable_poses(poses))
            time = self.clock.of(poses)
            track = frame_track(self.world, time, poses.log_time, poses.position, poses.orientation)
            tracks = TransformBuffer({self.base: track} if track else {})
        return tracks.then(moving_tracks(transforms, self.moving, self.clock))

    def place(self, feet: Sequence[Samples], around: TransformBuffer) -> "Placed":
        """Turn forces into the world and give sensors their positions, where frames tell.

        Args:
            feet: samples of each foot.
            around: the frames that move.
        """
        buffer = self.statics.then(around)

        def poses_of(frame: str, samples: Samples) -> Poses:
            return buffer.lookup(frame, self.world, self.clock.of(samples), samples.log_time)

        turned = [turn_forces(*each, poses_of) for each in zip(feet, self.links, strict=True)]
        placed = [
            place_points(samples, point, poses_of)
            for (samples, _), point in zip(turned, self.points, strict=True)
        ]
        told = (np.concatenate([known for _, known in each]) for each in (turned, placed))
        counts = [(int(known.sum()), int((~known).sum())) for known in told]
        return Placed(tuple(samples for samples, _ in placed), *counts)


@dataclass(frozen=True, slots=True)
class Placed:
    """Contacts with forces turned and sensors placed, as far as that is wanted and frames tell."""

    samples: tuple[Samples, ...]
    """One for each that was given."""
    turned: tuple[int, int]
    """Forces that were turned from a link's frame into the world, and that were not."""
    placed: tuple[int, int]
    """The same of samples without a contact point, for which the position of a frame stands in."""


def follow_frames(
    selection: Selection,
    probe: RecordedFrames,
    world: str,
    base: str,
    clock: TimeSource,
    *,
    turn_forces: bool,
    place_sensors: bool,
) -> WorldFrames | None:
    """Decide which frames are needed, and how they hang together.

    Args:
        selection: what is read.
        probe: parents that the log's own transforms give frames, and the links of the feet.
        world: frame to turn to.
        base: frame that odometry places in it.
        clock: the clock of samples and transforms.
        turn_forces: forces are in links' frames and wanted in the world.
        place_sensors: feet whose sensors tell no contact point are wanted where their frames are.

    Returns:
        None where no foot's frame is needed and connected.
    """
    parents = {
        child: next(iter(names)) for child, names in probe.parents.items() if len(names) == 1
    }
    if selection.odometry:
        # Odometry places the base; a second opinion would only contradict it.
        parents[base] = world
    links = tuple(
        link if turn_forces and link and chain_of_frames(parents, link, world) is not None else None
        for link in probe.links
    )
    named = _foot_frames(parents)
    sensors = [
        FramePoint(base, recorded=True)
        if any(source.in_base for source in selection.sources_of(foot))
        else _sensor(selection, probe, foot, parents, world, named)
        if place_sensors
        else None
        for foot in range(len(selection.robot.feet))
    ]
    # The world itself is no frame of a foot.
    points = tuple(
        point if point and chain_of_frames(parents, point.frame, world) else None
        for point in sensors
    )
    frames = {link for link in links if link} | {point.frame for point in points if point}
    if not frames:
        return None
    needed = {each for frame in frames for each in chain_of_frames(parents, frame, world) or ()}
    if selection.odometry:
        needed.discard(base)
    return WorldFrames(
        links=links,
        points=points,
        world=world,
        base=base,
        odometry_places_base=bool(selection.odometry),
        moving={each: parents[each] for each in needed - probe.statics.frames.keys()},
        statics=probe.statics.only(needed),
        clock=clock,
    )


def _foot_frames(frames: Iterable[str]) -> Mapping[LegPosition, str]:
    """Return the frames that are named like the feet of all legs, by where the leg is."""
    found = name_feet(frames, contacts_only=False).chosen
    if found is None or found.part is not Part.FOOT:
        return {}
    return {foot.position: foot.topic for foot in found.feet if foot.position}


def _sensor(
    selection: Selection,
    probe: RecordedFrames,
    foot: int,
    parents: Mapping[str, str],
    world: str,
    named: Mapping[LegPosition, str],
) -> FramePoint | None:
    """Return the position of a foot whose sensor tells forces but no contact points.

    It is at the frame of the robot's file or of its messages; where the log's transforms do not
    place that, at the frame that is named like the leg's foot.
    """
    sources = selection.sources_of(foot)
    if not selection.knows_force(foot) or any(source.has_points for source in sources):
        return None
    described = selection.robot.feet[foot]
    frame = described.frame or probe.links[foot]
    is_placed = frame is not None and chain_of_frames(parents, frame, world) is not None
    if described.frame is None and described.leg_position is not None and not is_placed:
        frame = named.get(described.leg_position, frame)
    return FramePoint(frame, described.contact_point_m) if frame else None


def frame_findings(frames: WorldFrames, placed: Placed) -> Iterator[Finding]:
    """Say how often the frames told what was asked of them."""
    forces = "link-frame forces turned into the world by the log's own transforms"
    recorded = "positions of feet in the base's frame turned into the world"
    origins = "contacts without a point placed at the origins of the feet's frames"
    points = [point for point in frames.points if point]
    for wanted, (done, left), cases, text in (
        (any(frames.links), placed.turned, ("forces",), forces),
        (any(point.recorded for point in points), placed.placed, (), recorded),
        (not all(point.recorded for point in points), placed.placed, (), origins),
    ):
        if wanted and left:
            missing = f"{text}: {done:,}; transforms were missing for {left:,}"
            yield Finding("TRANSFORMS_MISSING", missing, cases=cases)
        elif wanted:
            yield Finding("TRANSFORMS_MISSING", f"{text}: {done:,}", cases=("none",))
