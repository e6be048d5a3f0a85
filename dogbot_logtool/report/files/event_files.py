"""The events of a log as a file: our CSV, BIDS' events.tsv, or EUROBENCH's YAML of gait events."""

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Final

from dogbot_logtool.core.events.gait_labels import LABELS, SIDES, feet_by_side
from dogbot_logtool.errors import LogError
from dogbot_logtool.report.figures.events import EVENT_COLUMNS
from dogbot_logtool.report.figures.figure import Json
from dogbot_logtool.report.files.stats_csv import event_cells, write_events

BIDS_COLUMNS: Final = {"onset_s": "onset", "duration_s": "duration", "type": "trial_type"}
"""Names of our columns in BIDS; the others keep their names."""
LABELLED: Final = (".tsv", ".yaml", ".yml")
"""Suffixes of formats that hold the events of one log only."""
_UNKNOWN: Final = "n/a"

Places = Mapping[str, Sequence[str] | None]
"""Position of the leg of each foot, by its name; None where it is not known."""


def event_file(suffix: str, document: Json) -> str:
    """Return the text of a file of events.

    Args:
        suffix: of the file's name: ``.tsv`` BIDS, ``.yaml`` or ``.yml`` EUROBENCH, else our CSV.
        document: the log's JSON.

    Raises:
        LogError: the format cannot hold the events of these feet.
    """
    events: Sequence[Json] = document["events"]
    if suffix in {".yaml", ".yml"}:
        feet = {name: foot["place"] for name, foot in document["feet"].items()}
        return eurobench_yaml(events, feet)
    text = io.StringIO()
    if suffix == ".tsv":
        writer = csv.writer(text, dialect="excel-tab", lineterminator="\n")
        writer.writerow([BIDS_COLUMNS.get(name, name) for name in EVENT_COLUMNS])
        writer.writerows([cell or _UNKNOWN for cell in event_cells(each)] for each in events)
    else:
        write_events(text, events)
    return text.getvalue()


def eurobench_yaml(events: Sequence[Json], feet: Places) -> str:
    """Return touchdowns and lift-offs as lists of seconds by EUROBENCH's names.

    Raises:
        LogError: there are not one left and one right foot.
    """
    sides = feet_by_side(feet)
    if sides is None:
        named = ", ".join(feet) or "none"
        raise LogError(
            "EUROBENCH's YAML has events of a left and a right foot, and the log's feet are "
            f"{named}: name the file .tsv or .csv"
        )
    lines = []
    for short, side in SIDES.items():
        for label, kind in LABELS.items():
            times = [e["onset_s"] for e in events if (e["foot"], e["type"]) == (sides[side], kind)]
            lines.append(f"{short}_{label}: [{', '.join(f'{time:.9g}' for time in times)}]\n")
    return "".join(lines)
