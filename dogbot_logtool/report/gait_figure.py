"""The gait diagram and the load curves as a figure for a paper, drawn by matplotlib.

Above, a row a foot, filled while the foot is down, as Hildebrand drew gaits (Hildebrand,
Symmetrical gaits of horses, Science 150, 1965). Below, a panel a foot with its load over the same
time. All lengths are millimetres on paper.
"""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.scene.feet import foot_colour, short_names
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.errors import ExtraMissingError, LogError
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.curves import curve_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS: Final = ("pdf", "png", "svg")
ONE_COLUMN_MM: Final = 85.0
"""Width of a column in most journals of two columns; long names take more."""

_MM_PER_INCH: Final = 25.4
_DOTS_PER_INCH: Final = 600
_ROW, _BAR, _PANEL, _BETWEEN = 4.0, 2.8, 10.0, 1.8
_TOP, _BOTTOM, _LEFT, _RIGHT = 1.5, 8.0, 11.0, 2.0
_LETTER: Final = 1.8
"""Width of a wide letter."""
_LEAST_WIDTH: Final = 20.0
"""Least width of the axes."""

_GREY: Final = "#ececec"
"""Behind the load curves while the foot is down."""
_UNKNOWN: Final = "#999999"
_STYLE: Final[Sequence[str | Path]] = ["default", Path(__file__).with_suffix(".mplstyle")]
_NO_METADATA: Final[dict[str, dict[str, Any]]] = {
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None, "Format": None, "Type": None},
}

Window = tuple[float, float]
"""s since the log's start, from and to."""


def require_matplotlib() -> None:
    """Check that matplotlib is there.

    Raises:
        ExtraMissingError: it is not.
    """
    try:
        import matplotlib as mpl  # noqa: F401, PLC0415
    except ImportError as error:
        raise ExtraMissingError("--figure", "plot") from error


def gait_figure(walk: Walk, window: Window) -> "Figure":
    """Draw the figure.

    Bars are named ``stance-<foot>`` and lines ``load-<foot>`` in it, and in SVG.

    Args:
        walk: of a log.
        window: that is shown.

    Raises:
        LogError: there are no feet.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415
    from matplotlib.style import context  # noqa: PLC0415

    if not walk.feet:
        raise LogError("there are no feet to draw")
    if not walk.end > walk.origin:
        raise LogError("there is nothing to draw: all messages of the feet have the same time")
    names = [printable(name) for name in short_names([foot.name for foot in walk.feet])]
    records = [foot.record for foot in walk.feet]
    loaded = [row for row, each in enumerate(records) if each.has_force and len(each.track.time)]
    heights = [len(names) * _ROW, *(_PANEL for _ in loaded)]
    letters = max(map(len, names)) * _LETTER
    left, right = max(_LEFT, letters + 1.5), _RIGHT + (letters if loaded else 0.0)
    width = max(ONE_COLUMN_MM, left + right + _LEAST_WIDTH)
    height = _TOP + _BOTTOM + sum(heights) + _BETWEEN * len(loaded)
    with context(_STYLE):
        figure = Figure((width / _MM_PER_INCH, height / _MM_PER_INCH))
        parts = figure.add_gridspec(
            len(heights),
            height_ratios=heights,
            hspace=_BETWEEN / (sum(heights) / len(heights)),
            left=left / width,
            right=1.0 - right / width,
            top=1.0 - _TOP / height,
            bottom=_BOTTOM / height,
        )
        rows, *panels = (figure.add_subplot(parts[part]) for part in range(len(heights)))
        _draw_rows(rows, walk, names, window)
        for axes, row in zip(panels, loaded, strict=True):
            _draw_load(axes, walk, row, window)
            axes.annotate(
                names[row], (1.0, 0.5), (3.0, 0.0), xycoords="axes fraction",
                textcoords="offset points", va="center_baseline", parse_math=False,
            )  # fmt: skip
        _scale_loads(panels)
        _time_axis([rows, *panels], window)
        if panels:
            unit = "N" if walk.loads.weight_n is None else "body weights"
            middle = (panels[0].get_position().y1 + panels[-1].get_position().y0) / 2.0
            figure.text(0.6 / width, middle, f"Load ({unit})", rotation=90, va="center")
    return figure


def _draw_rows(axes: "Axes", walk: Walk, names: Sequence[str], window: Window) -> None:
    """Draw the gait diagram: a row a foot, from top to bottom."""
    middles = [-row * _ROW for row in range(len(names))]
    for row, (foot, middle) in enumerate(zip(walk.feet, middles, strict=True)):
        height: dict[str, Any] = {"yrange": (middle - _BAR / 2.0, _BAR)}
        axes.axhline(middle, color=_UNKNOWN, linewidth=0.3, zorder=0)
        _shade_unknown(axes, walk, foot, window, height)
        down = _bars(walk, foot.record.in_contact, window)
        bars = axes.broken_barh(down, **height, facecolor=foot_colour(row), linewidth=0.0)
        bars.set_gid(f"stance-{foot.name}")
    axes.set_ylim(-(len(names) - 0.5) * _ROW, 0.5 * _ROW)
    axes.set_yticks(middles, names, parse_math=False)
    axes.tick_params("y", length=0.0, pad=3.0)


def _draw_load(axes: "Axes", walk: Walk, row: int, window: Window) -> None:
    """Draw what a foot carries over time, with its stances shaded."""
    foot = walk.feet[row]
    height: dict[str, Any] = {"yrange": (0.0, 1.0), "transform": axes.get_xaxis_transform()}
    down = _bars(walk, foot.record.in_contact, window)
    axes.broken_barh(down, **height, facecolor=_GREY, linewidth=0.0, zorder=0)
    _shade_unknown(axes, walk, foot, window, height)
    start, end = _limits(walk, window)
    curve = curve_of(
        foot.record.track.time, foot.record.track.force, foot.record.gaps, whole=(start, end)
    )
    if curve is not None:
        # Over the window and no further.
        first = max(int(np.searchsorted(curve.time, start)) - 1, 0)
        last = int(np.searchsorted(curve.time, end, side="right")) + 1
        time = (curve.time[first:last] - walk.origin) / 1e9
        load = curve.value[first:last] / (walk.loads.weight_n or 1.0)
        (line,) = axes.plot(time, load, color=foot_colour(row))
        line.set_gid(f"load-{foot.name}")


def _shade_unknown(
    axes: "Axes", walk: Walk, foot: FootSteps, window: Window, height: dict[str, Any]
) -> None:
    """Hatch the time of which the foot's sensor says nothing."""
    whole = np.array([_limits(walk, window)], np.int64)
    axes.broken_barh(
        _bars(walk, timespans.subtract(whole, foot.known), window),
        **height,
        facecolor="white",
        edgecolor=_UNKNOWN,
        hatch="//////",
        linewidth=0.0,
        zorder=0.5,
    )


def _bars(walk: Walk, spans: Ints, window: Window) -> list[tuple[float, float]]:
    """Return start and width, s, of spans within a window."""
    inside = timespans.intersect([spans, np.array([_limits(walk, window)], np.int64)])
    edges = ((inside - walk.origin) / 1e9).tolist()
    return [(start, end - start) for start, end in edges]


def _limits(walk: Walk, window: Window) -> tuple[int, int]:
    start, end = (walk.origin + round(each * 1e9) for each in window)
    return start, end


def _scale_loads(panels: Sequence["Axes"]) -> None:
    """Give all panels the same scale, so that loads can be compared by eye."""
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415

    loads = [np.asarray(line.get_ydata(), np.float64) for axes in panels for line in axes.lines]
    highest = float(np.nanmax(np.concatenate([[0.0], *loads]))) or 1.0
    for axes in panels:
        # A little below zero, so that the axis does not hide an unloaded foot's line.
        axes.set_ylim(-0.04 * highest, 1.08 * highest)
        axes.yaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
        axes.spines[["top", "right"]].set_visible(False)


def _time_axis(stack: Sequence["Axes"], window: Window) -> None:
    for axes in stack:
        axes.set_xlim(*window)
    for axes in stack[:-1]:
        axes.set_xticks([])
    if len(stack) == 1:
        stack[0].spines[["top", "left", "right"]].set_visible(False)
    else:
        stack[0].set_frame_on(False)
    stack[-1].set_xlabel("Time (s)", labelpad=2.0)


def write_figure(figure: "Figure", file: BinaryIO, form: str) -> None:
    """Write a figure; the same bytes for the same figure.

    Args:
        figure: by `gait_figure`.
        file: where to.
        form: one of `FORMATS`.
    """
    from matplotlib.style import context  # noqa: PLC0415

    # A file that cannot be written, on a full disk, would upset matplotlib.
    drawn = io.BytesIO()
    with context(_STYLE):
        figure.savefig(drawn, format=form, dpi=_DOTS_PER_INCH, metadata=_NO_METADATA[form])
    file.write(drawn.getvalue())
