"""What tells whether a log of a dataset is still as it was measured."""

import hashlib
import os
from typing import Any

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.io import storage
from dogbot_logtool.io.storage import Location


@dataclass(frozen=True, slots=True)
class LogState:
    """A log as it is now."""

    name: str
    """Its whole path, or URL without query; as it may be shown."""
    key: str
    """Names it; two logs never have the same."""
    log_id: str
    """Changes with the log and the settings."""
    size: int
    """Bytes."""
    version: str
    """Time of its last change, or the store's own tag; empty if unknown, or if there is no such
    log."""
    settings_sha256: str

    @property
    def columns(self) -> dict[str, Any]:
        """Its columns of `logs`."""
        return {
            "log": self.name,
            "log_id": self.log_id,
            "log_key": self.key,
            "log_size_bytes": self.size,
            "log_version": self.version,
            "settings_sha256": self.settings_sha256,
        }


def state_of(location: Location, settings_sha256: str) -> LogState:
    """Look at a log.

    Args:
        location: of the log.
        settings_sha256: hash of all that its figures depend on beside it.
    """
    try:
        size, version = storage.version(location)
    except (LogtoolError, OSError):
        # Opening it reports what is wrong.
        size, version = 0, ""
    identity = os.fsencode(storage.identity(location))
    text = "\n".join((str(size), version, settings_sha256)).encode()
    return LogState(
        name=storage.shown(storage.from_root(location)),
        key=key_of(location),
        log_id=hashlib.sha256(identity + b"\n" + text).hexdigest()[:32],
        size=size,
        version=version,
        settings_sha256=settings_sha256,
    )


def key_of(location: Location) -> str:
    """Return what names a log in the dataset: a hash of its real path or its whole URL."""
    return hashlib.sha256(os.fsencode(storage.identity(location))).hexdigest()[:24]
