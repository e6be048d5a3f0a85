"""Interface of sources of base poses."""

from collections.abc import Callable, Mapping
from dataclasses import field
from functools import partial

import numpy as np

from dogbot_logtool.core.base.odometry import Odometry
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.decode.fields import Fields, text, time, vector
from dogbot_logtool.reader.messages.messages import DecodedMessages


@dataclass(frozen=True, slots=True)
class BasePoses:
    """Poses of the base that messages of one definition hold, in file order."""

    poses: Odometry
    channel: Ints
    """(n,) channel id of each pose."""
    worlds: tuple[str, ...] = ()
    """Frames that the poses are in, as recorded; also `bases`, the frames that they place."""
    bases: tuple[str, ...] = ()
    malformed: Mapping[int, int] = field(default_factory=dict)
    """Messages that could not be decoded, by channel id."""


@dataclass(frozen=True, slots=True)
class BaseSource:
    """One way in which messages of a type hold poses of the base."""

    type_name: str
    """``package/Name``; empty: any type."""
    fields: Fields
    """Fields that are read of each message."""
    read: Callable[[DecodedMessages, str], BasePoses]
    """Returns the poses; the string is the element, such as the name of a model."""
    elements: Callable[[DecodedMessages], frozenset[str]] | None = None
    """Returns what messages hold poses of, where that is several things; None: of one."""
    has_header: bool = True
    """Without one, log time is the only time."""
    has_one_pose: bool = True
    """Whether each message has one pose and one stamp."""
    is_transform: bool = False
    """Its poses are transforms of the log's own frame tree."""
    any_package: bool = False
    """Whether messages of this name and fields are taken from any package."""
    anything: bool = False
    """Such messages can be about anything: only topics that name the base are taken for it."""
    on_request: bool = False
    """It is only used if the user names it."""
    is_planned: bool = False
    """Its poses are what a planner wants, unless the topic's name says that they are current."""
    remark: str = ""
    """Caveats on its poses."""


def pose_source(
    type_name: str,
    pose: str = "",
    *,
    position: str = "position",
    orientation: str = "orientation",
    twist: tuple[str, str] | None = None,
    stamp: str = "header.stamp",
    world: str = "header.frame_id",
    base: str = "",
    any_package: bool = False,
    anything: bool = False,
    on_request: bool = False,
    is_planned: bool = False,
) -> BaseSource:
    """Return the source of messages that have one pose at a fixed path.

    Args:
        type_name: the type.
        pose: path of the pose; empty: the message itself.
        position: field of the position inside the pose.
        orientation: field of the quaternion inside the pose.
        twist: paths of the linear and the angular velocity; None: there are none.
        stamp: path of the stamp; empty: there is none.
        world: path of the frame that the pose is in; empty: there is none.
        base: path of the frame that it places; empty: there is none.
        any_package: see `BaseSource`.
        anything: see `BaseSource`.
        on_request: see `BaseSource`.
        is_planned: see `BaseSource`.
    """
    prefix = f"{pose}." if pose else ""
    at, turned = prefix + position, prefix + orientation
    fields: Fields = (*vector(at), *vector(turned, "xyzw"))
    if stamp:
        fields += (time(stamp),)
    fields += tuple(text(path) for path in (world, base) if path)
    for path in twist or ():
        fields += vector(path)

    read = partial(
        _read_pose,
        position=at,
        orientation=turned,
        twist=twist,
        stamp=stamp,
        world=world,
        base=base,
    )
    return BaseSource(
        type_name=type_name,
        fields=fields,
        read=read,
        has_header=bool(stamp),
        any_package=any_package,
        anything=anything,
        on_request=on_request,
        is_planned=is_planned,
    )


def _read_pose(
    messages: DecodedMessages,
    element: str,
    *,
    position: str,
    orientation: str,
    twist: tuple[str, str] | None,
    stamp: str,
    world: str,
    base: str,
) -> BasePoses:
    """Read the pose of each message at fixed paths; see `pose_source`."""
    del element
    table, count = messages.table, len(messages.channel)
    linear, angular = [table.vectors(path, "xyz") for path in twist] if twist else [None, None]
    return BasePoses(
        poses=poses_of(
            messages.log_time,
            table.nanoseconds(stamp) if stamp else np.zeros(count, np.int64),
            table.vectors(position, "xyz"),
            table.vectors(orientation, "xyzw"),
            linear,
            angular,
        ),
        channel=messages.channel,
        worlds=table.texts(world).encode()[1] if world else (),
        bases=table.texts(base).encode()[1] if base else (),
        malformed=messages.malformed,
    )


def poses_of(
    log_time: Ints,
    stamp: Ints,
    position: Floats,
    orientation: Floats,
    linear: Floats | None = None,
    angular: Floats | None = None,
) -> Odometry:
    """Return poses as columns; without velocities these are NaN.

    Args:
        log_time: (n,) ns.
        stamp: (n,) ns; 0: none.
        position: (n, 3) m.
        orientation: (n, 4) x, y, z, w.
        linear: (n, 3) m/s.
        angular: (n, 3) rad/s.
    """
    unknown = np.full((len(log_time), 3), np.nan)
    return Odometry(
        log_time=log_time,
        stamp=stamp,
        position=position,
        orientation=orientation,
        linear_velocity=unknown if linear is None else linear,
        angular_velocity=unknown if angular is None else angular,
    )
