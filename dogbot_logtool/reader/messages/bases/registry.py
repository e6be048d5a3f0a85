"""All sources of base poses, and the function through which every command reads them."""

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Final

from dogbot_logtool.core.base.odometry import Odometry, concatenate_odometry
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.messages.bases import dwl, lists, numbers, poses, transforms, unitree
from dogbot_logtool.reader.messages.bases.source import BasePoses, BaseSource
from dogbot_logtool.reader.messages.messages import check_channel, decode_channels

_SOURCES: Final = (
    *poses.SOURCES,
    dwl.SOURCE,
    *unitree.SOURCES,
    *lists.SOURCES,
    *transforms.SOURCES,
    numbers.OCS2,
)
BASE_SOURCES: Final[Mapping[str, tuple[BaseSource, ...]]] = {
    each.type_name: tuple(one for one in _SOURCES if one.type_name == each.type_name)
    for each in _SOURCES
}
"""By type name; a type of which definitions differ has several. The best types come first."""


@lru_cache(maxsize=1024)
def base_type(type_name: str) -> str:
    """Return the known type as which messages of a type are read; empty: as none.

    Robots' states are known in any package, since drivers copy them into packages of their own.
    Whether the fields are there, `check_base` tells.
    """
    if type_name in BASE_SOURCES:
        return type_name
    name = type_name.rpartition("/")[2]
    known = (one.type_name for one in _SOURCES if one.any_package)
    return next((one for one in known if one.rpartition("/")[2] == name), "")


def base_types(channels: Iterable[Channel]) -> frozenset[str]:
    """Return the types that hold poses: all that are known, and those of channels read as such."""
    own = {channel.type_name for channel in channels}
    return frozenset({*BASE_SOURCES, *(name for name in own if base_type(name))})


@dataclass(frozen=True, slots=True)
class Base:
    """The source of the base's poses."""

    source: BaseSource
    element: str = ""
    """Which of the poses in a message: a model, a link, a pair of frames; empty: the only one."""

    def read(self, batch: Batch, channels: Sequence[Channel]) -> list[BasePoses]:
        """Read the poses of a batch; one entry a definition, nearly always one."""
        decoded = decode_channels(batch, channels, self.source.fields)
        return [self.source.read(messages, self.element) for messages in decoded]


def base_source(channel: Channel) -> BaseSource:
    """Return the source that reads a channel.

    Raises:
        DefinitionError: none does; why.
    """
    reasons = []
    for source in BASE_SOURCES.get(base_type(channel.type_name), ()):
        try:
            check_channel(channel, source.fields)
        except DefinitionError as error:
            reasons.append(str(error))
        else:
            return source
    raise DefinitionError(reasons[0] if reasons else "it holds no poses that are known")


def check_base(channel: Channel) -> str:
    """Check that a channel's messages can be decoded; see `check_channel`."""
    return check_channel(channel, base_source(channel).fields)


def joined_poses(parts: Sequence[BasePoses]) -> Odometry:
    """Return all poses, in the order of the log."""
    return concatenate_odometry([part.poses for part in parts])
