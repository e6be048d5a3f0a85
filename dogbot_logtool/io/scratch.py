"""A temporary directory for copies that are read once."""

import atexit
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def scratch_folder() -> Iterator[Path]:
    """Make a directory of our own that is gone when the block ends.

    A file that is still open then loses its name, and its bytes when it is closed. Windows
    does not remove open files: there the directory is removed when the process ends.
    """
    folder = Path(tempfile.mkdtemp(prefix="dogbot-logtool."))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if folder.exists():
            atexit.register(shutil.rmtree, folder, ignore_errors=True)
