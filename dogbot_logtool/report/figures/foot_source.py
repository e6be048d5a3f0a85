"""The source of a foot's figures."""

from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.sensors.sensor_level import SensorLevel
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class FootSource:
    """The source of a foot's figures."""

    stats: Stats
    """Figures of the whole log."""
    row: int
    """Index of the foot in `stats.feet`."""
    foot: FootStatistics
    """The foot over the whole log, or in a segment of it."""

    @property
    def level(self) -> SensorLevel:
        """Reading of its unloaded sensor."""
        return self.stats.settings.sensor(self.row).level

    @property
    def per_weight(self) -> float | None:
        """1/N: turns newtons into body weights; None where the weight is not known."""
        weight = self.stats.loads.weight_n
        return None if weight is None else 1.0 / weight


def foot_sources(stats: Stats) -> dict[str, FootSource]:
    """Return what each foot's figures are taken from, by its name."""
    return {foot.name: FootSource(stats, row, foot) for row, foot in enumerate(stats.feet)}
