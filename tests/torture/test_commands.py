"""A few of the damaged logs on which `make torture` runs every command."""

import itertools
from pathlib import Path

import pytest

from tests.torture.commands import COMMANDS, SAMPLES, damaged_logs, torture


@pytest.mark.slow
def test_every_command_ends_well_on_damaged_logs(tmp_path: Path) -> None:
    logs = itertools.chain(SAMPLES[:1], damaged_logs(tmp_path, 2, seed=16))
    ended = list(torture(logs))
    assert [(command, log, one.faults) for command, log, one in ended if one.faults] == []
    assert len(ended) == 3 * len(COMMANDS)
    assert {one.exit_code for _, _, one in ended} >= {0, 3}
