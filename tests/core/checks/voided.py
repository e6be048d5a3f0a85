"""Metrics of a walk after the step that sets to null what findings void."""

from dogbot_logtool.core.analysis import NO_LOG, judge
from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.core.walk import Walk


def metrics(walk: Walk) -> WalkMetrics:
    """Return what is reported of a walk, which a test may have changed."""
    return judge(walk, NO_LOG).metrics
