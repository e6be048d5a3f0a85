"""The walk in 3D for the report's page: the robot's frames are read when the figures are known."""

from typing import Any

from dogbot_logtool.io.storage import Location
from dogbot_logtool.pipeline.options import StatsOptions
from dogbot_logtool.pipeline.probe import probe_log
from dogbot_logtool.pipeline.robot_model.limbs import read_limbs
from dogbot_logtool.pipeline.topics.annotated import open_recorded
from dogbot_logtool.pipeline.topics.selection import select_topics
from dogbot_logtool.report.page.replay import frame_times, replay
from dogbot_logtool.results import Measurement


def replay_of(
    source: Location, options: StatsOptions, measured: Measurement
) -> dict[str, Any] | None:
    """Return what the page's replay draws; None without poses of the base.

    Args:
        source: the log.
        options: those that it was measured with.
        measured: its figures, with load curves.

    Raises:
        LogError: the log cannot be read any more.
    """
    stats = measured.stats
    if not len(stats.base_history.time):
        return None
    time = frame_times(stats)
    log = open_recorded(source, options.topics.joined)
    try:
        selection = select_topics(log, options.topics)
        probe, clock = probe_log(log, selection, with_soles=True), stats.settings.clock
        limbs = read_limbs(log, selection, probe, clock, time, options.jobs)
        return replay(stats, time, limbs)
    finally:
        log.close()
