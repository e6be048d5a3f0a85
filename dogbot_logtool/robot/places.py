"""Where feet are whose sensors tell forces but no contact points."""

from dogbot_logtool.core.frames.transforms import chain_of_frames
from dogbot_logtool.core.frames.wrench_frame import FramePoint
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.robot.measuring.legs import named_frames
from dogbot_logtool.robot.selection import Selection


def sensor_points(
    selection: Selection, frames: KnownFrames, settings: WalkSettings
) -> list[FramePoint | None]:
    """Return the position of each foot without contact points; None: it has some, or no force.

    It is at the frame of the robot's file or of its messages; where the log's transforms do not
    place that, at the frame that is named like the leg's foot.
    """
    parents = {child: next(iter(each)) for child, each in frames.parents.items() if len(each) == 1}
    if selection.odometry:
        parents[frames.base] = frames.world
    named = named_frames(selection.robot.feet, parents)
    points: list[FramePoint | None] = []
    for foot, described in enumerate(selection.robot.feet):
        sources = selection.sources_of(foot)
        if any(source.in_base for source in sources):
            points.append(FramePoint(frames.base, recorded=True))
            continue
        if not settings.feet[foot].has_force or any(source.has_points for source in sources):
            points.append(None)
            continue
        frame = described.frame or frames.links[foot]
        is_placed = frame and chain_of_frames(parents, frame, frames.world) is not None
        if described.frame is None and described.leg_position is not None and not is_placed:
            frame = named.get(foot, frame)
        points.append(FramePoint(frame, described.contact_point_m) if frame else None)
    return points
