"""What the figures of a foot are taken from."""

from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.sensors.sensor_level import SensorLevel
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class FootSource:
    """What the figures of a foot are taken from."""

    stats: Stats
    """Of the whole log."""
    row: int
    """Of the foot in `stats.feet`."""
    foot: FootStatistics
    """The foot over the whole log, or in a segment of it."""

    @property
    def level(self) -> SensorLevel:
        """What its unloaded sensor reads."""
        return self.stats.settings.sensor(self.row).level

    @property
    def per_weight(self) -> float | None:
        """1/N: turns newtons into body weights; None where the weight is not known."""
        weight = self.stats.loads.weight_n
        return None if weight is None else 1.0 / weight


def foot_sources(stats: Stats) -> dict[str, FootSource]:
    """Return what each foot's figures are taken from, by its name."""
    return {foot.name: FootSource(stats, row, foot) for row, foot in enumerate(stats.feet)}
