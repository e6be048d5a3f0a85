"""Link-frame wrenches turned into the world, with the log's own transforms and its odometry."""

from collections.abc import Iterable, Sequence

import numpy as np

from dogbot_logtool.core.clock import TimeSource
from dogbot_logtool.core.contacts import Samples
from dogbot_logtool.core.odometry import Odometry, usable_poses
from dogbot_logtool.core.recorded_transforms import RecordedTransforms
from dogbot_logtool.core.transform_buffer import ForcesToWorld, TransformBuffer
from dogbot_logtool.findings import Finding, note, warning


class WorldForces:
    """Turns the forces of a log that streams past, batch by batch and in order."""

    def __init__(
        self,
        links: Sequence[str | None],
        *,
        world_frame: str,
        base_frame: str,
        static_channels: frozenset[int],
        clock: TimeSource,
    ) -> None:
        """Set up.

        Args:
            links: frame of each foot's wrenches; None where it is not known.
            world_frame: frame to turn forces to.
            base_frame: frame that odometry places in the world.
            static_channels: ids of the channels whose transforms hold for ever.
            clock: the clock that samples and transforms are placed on.
        """
        self._buffer = TransformBuffer()
        self._forces = ForcesToWorld(self._buffer, links, world_frame, clock)
        self._world, self._base = world_frame, base_frame
        self._static = static_channels
        self._clock = clock

    def add(
        self,
        samples: Iterable[Samples],
        odometry: Odometry,
        transforms: Iterable[RecordedTransforms],
    ) -> list[Samples]:
        """Take in a batch; return the samples that no later transform can change."""
        poses = odometry.pick(usable_poses(odometry))
        time = poses.time if self._clock is TimeSource.HEADER else poses.log_time
        self._buffer.add(self._world, self._base, time, poses.position, poses.orientation)
        for recorded in transforms:
            self._add_recorded(recorded)
        return [ready for one in samples for ready in self._forces.add(one)]

    def _add_recorded(self, recorded: RecordedTransforms) -> None:
        pair = recorded.parent * len(recorded.children) + recorded.child
        static = np.isin(recorded.channel, list(self._static))
        time = recorded.stamp if self._clock is TimeSource.HEADER else recorded.log_time
        for number in np.unique(pair).tolist():
            parent = recorded.parents[number // len(recorded.children)]
            child = recorded.children[number % len(recorded.children)]
            if child.lstrip("/") == self._base:
                # Odometry places the base; a second opinion would only contradict it.
                continue
            rows = np.flatnonzero(pair == number)
            self._buffer.add(
                parent,
                child,
                time[rows],
                recorded.translation[rows],
                recorded.rotation[rows],
                static=bool(static[rows[0]]),
            )

    def finish(self) -> list[Samples]:
        """End the log: return the samples that still wait."""
        return self._forces.finish()

    def finding(self) -> Finding:
        """Say how many forces were turned."""
        turned, left = self._forces.turned, self._forces.not_turned
        text = f"link-frame forces turned into the world by the log's own transforms: {turned:,}"
        if not left:
            return note("FORCES_TURNED", text)
        return warning("FORCES_TURNED", f"{text}; transforms were missing for {left:,}")
