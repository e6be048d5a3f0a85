"""Commanded and measured velocity over time."""

from typing import Final

from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.page.charts.drawing import SECOND, Drawing
from dogbot_logtool.report.page.charts.stacked_rows import Line, Row, stacked

_ROWS: Final = (
    ("forward", "m/s", 0.1),
    ("to the left", "m/s", 0.1),
    ("yaw rate", "rad/s", 0.1),
)
"""Title of each column of the velocities, unit, and the span that fills the row at least."""


def tracked_commands(stats: Stats) -> Drawing | None:
    """Draw commanded and measured velocity, an axis a row; None without commands."""
    track = stats.command_track
    if track is None or len(track.time) == 0:
        return None
    rows, words = [], []
    for column, (title, unit, least) in enumerate(_ROWS):
        rms = track.errors(column)[3]
        if rms is None:
            continue
        lines = (
            Line("measured", track.time, track.measured[:, column]),
            Line("commanded", track.time, track.commanded[:, column], SECOND, "dash"),
        )
        rows.append(Row(title, unit, 3, least, lines))
        words.append(f"{title.capitalize()}: error {rms:.3f} {unit} (root mean square).")
    caption = (
        "Velocity of the base in its own axes (line) and as commanded (dashed), both averaged over "
        f"{track.window_ns / 1e9:.2f} s, so that the gait's own swing is left out. No line where "
        f"there is no command. {' '.join(words)}"
    )
    alt = f"Commanded and measured velocity over time. {' '.join(words)}"
    figure = stacked(stats, rows, track.breaks)
    return Drawing("commands", "Commands", alt, caption, figure, over_time=True)
