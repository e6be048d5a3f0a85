"""Messages that list several poses: Gazebo's models and links by name, and paths."""

from typing import Final

import numpy as np

from dogbot_logtool.reader.decode.fields import HEADER, table, texts, vector
from dogbot_logtool.reader.decode.message_layout import ELEMENT
from dogbot_logtool.reader.messages.bases.source import BasePoses, BaseSource, poses_of
from dogbot_logtool.reader.messages.messages import DecodedMessages


def _gazebo_names(messages: DecodedMessages) -> frozenset[str]:
    _, names = messages.table.nested("name").table.texts(ELEMENT).encode()
    return frozenset(names)


def _gazebo_poses(messages: DecodedMessages, element: str) -> BasePoses:
    """Return the poses of a model or link, wherever in each message it stands."""
    names, poses = messages.table.nested("name"), messages.table.nested("pose")
    code, known = names.table.texts(ELEMENT).encode()
    wanted = known.index(element) if element in known else -1
    named = np.flatnonzero(code == wanted)
    message = names.parent[named]
    at, kept = poses.rows_at(message, names.index[named])
    order = np.argsort(message[kept], kind="stable")
    message, at = message[kept][order], at[kept][order]
    return BasePoses(
        poses=poses_of(
            messages.log_time[message],
            np.zeros(len(message), np.int64),
            poses.table.vectors("position", "xyz")[at],
            poses.table.vectors("orientation", "xyzw")[at],
        ),
        channel=messages.channel[message],
        malformed=messages.malformed,
    )


def _last_poses(messages: DecodedMessages, element: str) -> BasePoses:
    """Return the last pose of each path, which is the newest where past poses pile up."""
    del element
    nested = messages.table.nested("poses")
    last = np.full(len(messages.channel), -1, np.int64)
    order = np.argsort(nested.parent, kind="stable")
    last[nested.parent[order]] = order
    message = np.flatnonzero(last >= 0)
    rows = last[message]
    _, worlds = messages.table.texts("header.frame_id").encode()
    return BasePoses(
        poses=poses_of(
            messages.log_time[message],
            messages.table.nanoseconds("header.stamp")[message],
            nested.table.vectors("pose.position", "xyz")[rows],
            nested.table.vectors("pose.orientation", "xyzw")[rows],
        ),
        channel=messages.channel[message],
        worlds=worlds,
        malformed=messages.malformed,
    )


_GAZEBO_FIELDS: Final = (
    texts("name"),
    table("pose", *vector("position"), *vector("orientation", "xyzw")),
)
SOURCES: Final = (
    *(
        BaseSource(
            type_name,
            _GAZEBO_FIELDS,
            _gazebo_poses,
            _gazebo_names,
            has_header=False,
            has_one_pose=False,
        )
        for type_name in ("gazebo_msgs/ModelStates", "gazebo_msgs/LinkStates")
    ),
    BaseSource(
        "nav_msgs/Path",
        (
            *HEADER,
            table("poses", *vector("pose.position"), *vector("pose.orientation", "xyzw")),
        ),
        _last_poses,
        has_one_pose=False,
        on_request=True,
        remark="the last pose of each path is taken: the newest one, or a plan's goal",
    ),
)
