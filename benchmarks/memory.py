"""Prints the most memory that a command held at any time, all its processes together.

Pages that processes share are counted once, each in its part (Linux's PSS). The command is slowed
down by that, so its time is to be taken in another run.

    python benchmarks/memory.py COMMAND [WORDS...]      prints MiB
"""

import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import psutil

_EVERY_S: Final = 0.02


def peak_mib(command: Sequence[str | Path]) -> float:
    """Run a command to its end; its output goes nowhere.

    Raises:
        SystemExit: it fails.
    """
    peak = 0
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        top = psutil.Process(process.pid)
        while process.poll() is None:
            peak = max(peak, _memory(top))
            time.sleep(_EVERY_S)
    if process.returncode:
        raise SystemExit(f"{command} failed with exit code {process.returncode}")
    return peak / (1 << 20)


def _memory(top: psutil.Process) -> int:
    """Return the bytes that a process and all that it started hold now."""
    total = 0
    try:
        for process in (top, *top.children(recursive=True)):
            total += process.memory_full_info().pss
    except (psutil.NoSuchProcess, psutil.AccessDenied, ProcessLookupError):
        # One ended while it was looked at; the next look tells.
        return 0
    return total


if __name__ == "__main__":
    print(f"{peak_mib(sys.argv[1:]):.1f}")
