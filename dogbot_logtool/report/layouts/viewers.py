"""The registry of viewers for which `layout` sets up a view."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from dogbot_logtool.report.layouts.view import View

DEFAULT_VIEWER: Final = "foxglove"


@dataclass(frozen=True, slots=True)
class Viewer:
    """One viewer."""

    name: str
    summary: str
    suffix: str
    """Of its files."""
    layout: Callable[["View"], dict[str, Any]]
    """Returns the view; written as JSON, which is YAML, too."""


def _foxglove(view: "View") -> dict[str, Any]:
    from dogbot_logtool.report.layouts.foxglove import foxglove_layout  # noqa: PLC0415

    return foxglove_layout(view)


def _rviz(view: "View") -> dict[str, Any]:
    from dogbot_logtool.report.layouts.rviz import rviz_config  # noqa: PLC0415

    return rviz_config(view)


_VIEWERS: Final = (
    Viewer("foxglove", "Foxglove and Lichtblick", ".json", _foxglove),
    Viewer("rviz", "RViz, for logs converted with --encoding ros1", ".rviz", _rviz),
)
VIEWERS: Final[Mapping[str, Viewer]] = {each.name: each for each in _VIEWERS}
"""By name, in the order of ``--help``."""
