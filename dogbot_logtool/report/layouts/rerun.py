"""A blueprint for Rerun: the robot beside load curves and events.

Rerun draws the robot's description and the transforms, but no scene messages, so there are neither
arrows nor support. Blueprints belong to an application id, which `rerun mcap convert` sets.
"""

from importlib.util import find_spec
from math import cos, radians, sin
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final

from dogbot_logtool.core.scene.foot_style import colour_parts, foot_colour
from dogbot_logtool.errors import ExtraMissingError
from dogbot_logtool.writer.topics import EVENTS_TOPIC, load_topic

if TYPE_CHECKING:
    from dogbot_logtool.report.layouts.view import View

APPLICATION: Final = "dogbot_logtool"
_TIMELINE: Final = "message_log_time"
_LOAD: Final = "dogbot_logtool.Load:message"
"""The load messages of `convert --encoding foxglove`, as Rerun names what it has no type for."""


def require_rerun() -> None:
    """Check for Rerun's library.

    Raises:
        ExtraMissingError: it is not there.
    """
    if find_spec("rerun") is None:
        raise ExtraMissingError("layout --viewer rerun", "rerun")


def rerun_blueprint(view: "View") -> bytes:
    """Return the content of an ``.rbl`` file.

    Raises:
        ExtraMissingError: Rerun's library is not there.
    """
    require_rerun()
    import rerun.blueprint as rrb  # noqa: PLC0415 - an extra

    robot = rrb.Spatial3DView(
        origin="/",
        name="Robot",
        spatial_information=rrb.SpatialInformation(target_frame=view.world_frame),
        eye_controls=_eye(rrb, view),
    )
    loads = [_load(rrb, view, row) for row in range(len(view.feet))]
    blueprint = rrb.Blueprint(
        rrb.Horizontal(
            robot, rrb.Vertical(*loads, rrb.TextLogView(origin=EVENTS_TOPIC, name="Events"))
        ),
        rrb.TimePanel(timeline=_TIMELINE, state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
    )
    with TemporaryDirectory() as folder:
        file = Path(folder) / "view.rbl"
        blueprint.save(APPLICATION, file)
        return file.read_bytes()


def _eye(rrb: Any, view: "View") -> Any:  # noqa: ANN401 - of a library without types
    """Return a camera that faces the robot and goes along with its body."""
    away, angle = 3.7 * view.size_m, radians(view.camera_in_world_deg)
    body = f"/{view.robot_name}/visual_geometries/{view.base_frame}/visual_0"
    return rrb.EyeControls3D(
        position=[away * cos(angle), away * sin(angle), 0.35 * away],
        look_target=[0.0, 0.0, 0.0],
        tracking_entity=body if view.robot_name else None,
    )


def _load(rrb: Any, view: "View", row: int) -> Any:  # noqa: ANN401 - of a library without types
    """Return the load curve of a foot."""
    import rerun  # noqa: PLC0415 - an extra
    from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping  # noqa: PLC0415

    foot = view.feet[row]
    force = VisualizerComponentMapping(
        "Scalars:scalars",
        ComponentSourceKind.SourceComponent,
        source_component=_LOAD,
        selector=".force",
    )
    colour = [round(255.0 * part) for part in colour_parts(foot_colour(row))]
    line = rerun.SeriesLines(colors=colour, names=foot)
    return rrb.TimeSeriesView(
        origin=load_topic(foot),
        name=f"{foot} [N]",
        overrides={load_topic(foot): [line.visualizer(mappings=[force])]},
    )
