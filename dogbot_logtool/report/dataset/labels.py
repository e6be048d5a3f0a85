"""Labels of logs: columns that the call names, such as which robot or which firmware."""

import re
from collections.abc import Mapping, Sequence
from typing import Final

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.storage import valid_unicode
from dogbot_logtool.report.dataset.schema import PARTITIONS, tables

Labels = Mapping[str, str | None]
"""Values by name; None: the log has no such label."""
_NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,62}")


def parse_labels(words: Sequence[str]) -> Labels:
    """Return the labels of `--label` options; an empty value takes a label away.

    Raises:
        CallError: one is no ``name=value``, has a name that no column may have, or is there twice.
    """
    columns = {*PARTITIONS, *(each.name for table in tables().values() for each in table)}
    labels: dict[str, str | None] = {}
    for word in words:
        name, equals, value = word.partition("=")
        said = f"--label {valid_unicode(word)}"
        if not equals:
            raise CallError(f"{said}: must be NAME=VALUE, such as firmware=3.2")
        if not _NAME.fullmatch(name):
            raise CallError(
                f"{said}: a name has up to 63 small letters, digits and _, a letter first"
            )
        if name in columns:
            raise CallError(f"{said}: the dataset has a column {name} already; choose another name")
        if name in labels:
            raise CallError(f"{said}: {name} is there twice")
        labels[name] = valid_unicode(value) or None
    return labels
