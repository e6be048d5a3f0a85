"""What a log tells of its frames and sensors, read whole."""

from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.robot.probe import Probe, probe_recording
from dogbot_logtool.robot.selection import Selection


def probe_log(log: Log, selection: Selection, *, with_soles: bool = False) -> Probe:
    """Read the topics of a selection."""
    recording = read_recording(log, selection.wanted(), 1).recording
    return probe_recording(recording, selection, with_soles=with_soles)
