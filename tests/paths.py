"""Where things lie."""

from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[1]
SAMPLE_LOGS: Final = ROOT / "sample_logs"
TROT, WALK, TROUBLED = (
    SAMPLE_LOGS / f"dogbot_{name}" for name in ("trot.bag", "walk.mcap", "troubled.bag")
)
