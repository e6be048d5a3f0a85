import gc
import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from tests.shell import Shell

# How long an example takes says more of the machine than of the code.
settings.register_profile(
    "untimed", deadline=None, max_examples=50, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile("fuzz", settings.get_profile("untimed"), max_examples=20_000)
settings.load_profile("untimed")

# A fifth of the time went into looking for rings of objects among those that stay.
gc.set_threshold(100_000, 50, 50)

# pytest-xdist sets these, and programs that are started would take their output for a terminal's.
for name in ("COLUMNS", "LINES"):
    os.environ.pop(name, None)
# Programs that are started compile all modules anew where they may not keep them.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)


@pytest.fixture
def shell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Shell:
    folder = tmp_path / "here"
    folder.mkdir()
    return Shell(folder, monkeypatch, capsys)
