"""Two recordings of a test."""

from pathlib import Path

import pytest

from tests.comparison.recordings import Pair


@pytest.fixture
def pair(tmp_path: Path) -> Pair:
    return Pair(tmp_path)
