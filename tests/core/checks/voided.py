"""Metrics of a walk after the step that sets to null what findings void."""

from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.metrics import Log, WalkMetrics
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.core.walk_metrics.rest import Chosen
from dogbot_logtool.core.walk_metrics.walk import metrics_of


def metrics(stats: Walk) -> WalkMetrics:
    """Return what is reported of a walk."""
    log = Log("walk.bag", "ROS 1 bag", "ros1", 0.0, 1.0, 1, 0, 0)
    return metrics_of(
        stats, log, Chosen("dogbot", robot_guessed=False, contact_planned=False), findings_of(stats)
    )
