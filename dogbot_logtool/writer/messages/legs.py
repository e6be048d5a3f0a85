"""Messages of `/legs`, made of columns, those of the same standing feet at a time."""

from collections.abc import Iterator
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.scene.foot_style import colour_parts, foot_colour
from dogbot_logtool.core.scene.legs import LegLines
from dogbot_logtool.writer.encodings.encoding import Encoding, SupportLook, leg_points
from dogbot_logtool.writer.message_records import record_template, write_log_time
from dogbot_logtool.writer.template import TEMPLATES_KEPT, Stamps, Template


class LegsWriter:
    """Makes the messages of one channel; called in several threads or processes at once."""

    def __init__(self, channel: int, encoding: Encoding, frame: str, look: SupportLook) -> None:
        self._channel = channel
        self._encoding = encoding
        self._frame = frame
        self._look = look

    def records(self, legs: LegLines, stamps: Stamps) -> Iterator[NDArray[np.void]]:
        """Yield the message records of legs, those of the same standing feet at a time.

        Args:
            legs: (n,) times.
            stamps: the same times in the encoding's form.
        """
        standing = np.isfinite(legs.ends[:, :, 0, 0])
        patterns, pattern = np.unique(standing, axis=0, return_inverse=True)
        for number, flags in enumerate(patterns):
            feet = np.flatnonzero(flags).tolist()
            rows = np.flatnonzero(pattern.reshape(-1) == number)
            template = _template(
                self._encoding, tuple(feet), self._frame, self._look, self._channel
            )
            records = template.copies(len(rows))
            template.write_stamps(records, "stamp", stamps.pick(rows))
            if feet:
                ends = legs.ends[rows][:, feet].reshape(len(rows), -1, 3)
                template.point_array(leg_points(len(feet))).view(records)[:] = ends
            write_log_time(records, legs.log_time[rows])
            yield records


@lru_cache(TEMPLATES_KEPT)
def _template(
    encoding: Encoding, feet: tuple[int, ...], frame: str, look: SupportLook, channel: int
) -> Template:
    """Return the template of messages in which these feet stand; see `Encoding.legs`."""
    colours = [colour_parts(foot_colour(foot)) for foot in feet]
    return record_template(encoding.legs(colours, frame, look), channel)
