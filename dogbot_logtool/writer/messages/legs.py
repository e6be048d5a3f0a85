"""Messages of `/legs`, made of columns, those of the same standing feet at a time."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.scene.foot_style import colour_parts, foot_colour
from dogbot_logtool.core.scene.legs import LegLines
from dogbot_logtool.writer.encodings.encoding import Encoding, SupportLook, leg_points
from dogbot_logtool.writer.message_records import kept_template, write_log_time
from dogbot_logtool.writer.template import Stamps


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
            colours = tuple(colour_parts(foot_colour(foot)) for foot in feet)
            template = kept_template(
                self._encoding.legs, self._channel, colours, self._frame, self._look
            )
            records = template.copies(len(rows))
            template.write_stamps(records, "stamp", stamps.pick(rows))
            if feet:
                ends = legs.ends[rows][:, feet].reshape(len(rows), -1, 3)
                template.point_array(leg_points(len(feet))).view(records)[:] = ends
            write_log_time(records, legs.log_time[rows])
            yield records
