"""What is drawn, as columns of the slots of messages."""

from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.foot_style import FOOT_COLOURS, colour_parts, foot_colour
from dogbot_logtool.core.scene.labels import Labels
from dogbot_logtool.core.scene.legs import LegLines
from dogbot_logtool.core.scene.loads import Loads
from dogbot_logtool.core.scene.support_scene import SupportScene
from dogbot_logtool.writer.drawing import SHAFT_SHARE
from dogbot_logtool.writer.template import Columns

_COLOURS: Final = np.array([colour_parts(foot_colour(foot)) for foot in range(len(FOOT_COLOURS))])
"""(k, 3) red, green, blue of feet."""
_LABEL_WIDTH: Final = 6
"""Characters of the number and its unit in a label, padded with spaces."""
_LARGEST_N: Final = 9999.0
_BEYOND: Final = ">10 kN"


def _parts(names: str, values: Floats | Float32s, prefix: str = "") -> Columns:
    """Return the parts of vectors, quaternions or colours, (n, parts)."""
    return {f"{prefix}{name}": column for name, column in zip(names, values.T, strict=True)}


def transform_columns(translation: Floats, rotation: Floats) -> Columns:
    """Return the columns of messages of k transforms each.

    Args:
        translation: (n, k, 3) m.
        rotation: (n, k, 4) quaternions, x y z w.
    """
    columns: dict[str, Any] = {}
    for index in range(translation.shape[1]):
        columns |= _parts("xyz", translation[:, index], f"{index}.")
        columns |= _parts("xyzw", rotation[:, index], f"{index}.q")
    return columns


def arrow_columns(arrows: Arrows) -> Columns:
    """Return the columns of arrows; an encoding takes the length, or its parts."""
    return {
        **_parts("xyz", arrows.position),
        **_parts("xyzw", arrows.orientation, "q"),
        **_parts("rgba", arrows.colour),
        "length": arrows.length,
        "shaft": SHAFT_SHARE * arrows.length,
        "head": (1.0 - SHAFT_SHARE) * arrows.length,
    }


def label_columns(labels: Labels) -> Columns:
    """Return the columns of labels."""
    text = np.full(len(labels.shown), b"", f"S{_LABEL_WIDTH}")
    text[labels.shown] = [
        (_BEYOND if force > _LARGEST_N else f"{force:.0f} N").center(_LABEL_WIDTH).encode()
        for force in labels.force[labels.shown].tolist()
    ]
    return {**_parts("xyz", labels.position), "text": text}


def load_columns(loads: Loads) -> Columns:
    """Return the columns of loads."""
    return {
        "in_contact": loads.in_contact,
        "force": loads.force,
        "force_bw": loads.body_weights,
    }


def leg_columns(legs: LegLines) -> Columns:
    """Return the columns of lines from hips to feet."""
    columns: dict[str, Any] = {}
    for foot in range(legs.ends.shape[1]):
        columns |= _parts("xyz", legs.ends[:, foot, 0], f"hip{foot}.")
        columns |= _parts("xyz", legs.ends[:, foot, 1], f"foot{foot}.")
    return columns


def support_points(scene: SupportScene) -> Iterator[tuple[str, Floats]]:
    """Yield the points of what the robot stands on, (n, k, 3), by the names of `SupportShape`."""
    yield "line", scene.outline
    yield "pressure", scene.pressure[:, None]
    yield "projection", scene.projection[:, None]
    yield "touchdown", scene.touchdowns


def support_columns(scene: SupportScene) -> Columns:
    """Return the columns of what the robot stands on."""
    columns = dict(_parts("rgba", scene.colour))
    for name, points in support_points(scene):
        for index in range(points.shape[1]):
            columns |= _parts("xyz", points[:, index], f"{name}{index}.")
    for index, feet in enumerate(scene.touchdown_feet.T):
        columns |= _parts("rgb", _COLOURS[feet % len(_COLOURS)], f"touchdown{index}.")
    return columns
