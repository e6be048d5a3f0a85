"""Figures of contact samples and poses, as if they were the columns of a log."""

from collections.abc import Sequence

import numpy as np

from dogbot_logtool.core.analysis import NO_LOG, analyse, judge
from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.base.poses import Odometry, no_odometry
from dogbot_logtool.core.contact.contacts import Samples, no_samples
from dogbot_logtool.core.gait.feet import foot_metrics
from dogbot_logtool.core.metrics import Foot, WalkMetrics
from dogbot_logtool.core.recording import Recording, Times, VectorTopic
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.core.walk import Walk


def foot_samples(
    foot: int,
    stamp: Ints,
    log_time: Ints,
    touching: Flags,
    force: Floats,
    point: Floats,
    normal: Floats | tuple[float, float, float] = (0.0, 0.0, 1.0),
) -> Samples:
    """Return a foot's messages as the reader makes them; points are NaN where there are none."""
    known = touching & np.isfinite(point).all(axis=1)
    return Samples(
        foot=np.full(len(stamp), foot, np.int64),
        log_time=log_time,
        stamp=stamp,
        in_contact=touching,
        force=np.where(touching[:, None], force, 0.0),
        in_world=np.zeros(len(stamp), np.bool_),
        points=known.astype(np.int64),
        position=np.where(known[:, None], point, np.nan),
        normal=np.where(known[:, None], normal, np.nan),
    )


def analysed(
    settings: WalkSettings,
    samples: Sequence[Samples] = (),
    odometry: Odometry | None = None,
    accelerations: VectorTopic | None = None,
) -> Walk:
    """Analyse the samples of some feet, each with its own topic, and the poses of a base."""
    poses = odometry or no_odometry()
    topics = {
        settings.feet[int(each.foot[0])].topic: Times(each.log_time, each.stamp) for each in samples
    }
    if settings.odometry_topic and len(poses.stamp):
        topics[settings.odometry_topic] = Times(poses.log_time, poses.stamp)
    feet = [no_samples()] * len(settings.feet)
    for each in samples:
        feet[int(each.foot[0])] = each
    recording = Recording(feet=tuple(feet), base=poses, accelerations=accelerations, topics=topics)
    return analyse(recording, settings)


def feet_of(stats: Walk) -> list[Foot]:
    """Return the metrics of each foot over the whole log, before any is void."""
    return [foot_metrics(foot, stats.loads.weight_n, stats.origin) for foot in stats.feet]


def metrics(walk: Walk) -> WalkMetrics:
    """Return what is reported of a walk, less what findings void."""
    return judge(walk, NO_LOG).metrics
