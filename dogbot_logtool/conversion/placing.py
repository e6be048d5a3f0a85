"""Contacts of a batch placed in the world by the log's own frames."""

from dataclasses import replace

from dogbot_logtool.conversion.carried import Carried
from dogbot_logtool.conversion.reading import ReadBatch
from dogbot_logtool.core.link_frames import FrameCounts
from dogbot_logtool.plan import Plan


def placed(read: ReadBatch, carried: Carried, plan: Plan) -> ReadBatch:
    """Turn forces and place sensors, where that is wanted and the frames tell.

    Args:
        read: the batch.
        carried: what all earlier batches hand on.
        plan: what is to be done.
    """
    if plan.frames is None or read.frames is None:
        return read
    around = read.frames.around(carried.transforms)
    counts = FrameCounts()
    contacts = []
    for each in read.contacts:
        samples, told = plan.frames.place(each.felt.samples, around)
        contacts.append(replace(each, felt=replace(each.felt, samples=samples)))
        counts += told
    return replace(read, contacts=tuple(contacts), frame_counts=counts)
