"""Messages of `/tf`, made of columns."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.base.poses import Transforms
from dogbot_logtool.core.frames.kinematics import LinkTransforms
from dogbot_logtool.writer.encodings.encoding import Encoding
from dogbot_logtool.writer.message_records import kept_template, write_log_time, write_pose


class BaseTransformWriter:
    """Makes transforms of the base."""

    def __init__(self, channel: int, encoding: Encoding, world: str, base: str) -> None:
        self._template = kept_template(encoding.transform, channel, world, base)

    def records(self, transforms: Transforms) -> NDArray[np.void]:
        """Return the message records of transforms."""
        records = self._template.copies(len(transforms.log_time))
        write_log_time(records, transforms.log_time)
        self._template.write_time(records, "stamp", transforms.stamp)
        write_pose(records, transforms.translation, transforms.rotation)
        return records


class LinkTransformWriter:
    """Makes messages with a transform of each link."""

    def __init__(self, channel: int, encoding: Encoding, links: Sequence[tuple[str, str]]) -> None:
        self._template = kept_template(encoding.transforms, channel, tuple(links))

    def records(self, links: LinkTransforms) -> NDArray[np.void]:
        """Return the message records of links."""
        records = self._template.copies(len(links.log_time))
        write_log_time(records, links.log_time)
        for index in range(links.poses.translation.shape[1]):
            self._template.write_time(records, f"{index}.stamp", links.stamp)
            position, turn = links.poses.translation[:, index], links.poses.rotation[:, index]
            write_pose(records, position, turn, f"{index}.")
        return records
