"""What is found while a walk is drawn."""

from collections import Counter
from collections.abc import Iterator, Mapping

from dogbot_logtool.conversion.annotate import Scene
from dogbot_logtool.core.base.poses import usable_poses
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.finding import Finding


def bad_poses(recording: Recording) -> int:
    """Return how many poses cannot be written."""
    return int((~usable_poses(recording.base)).sum())


def drawing_findings(
    scene: Scene, recording: Recording, moved: Mapping[str, str], counts: Counter[str]
) -> Iterator[Finding]:
    """Yield what was found in planning and drawing.

    Args:
        scene: what was drawn.
        recording: the columns that it is made of.
        moved: new names of topics that the log has as something else.
        counts: annotations that lack something.
    """
    plan = scene.plan
    yield from (*plan.findings, *scene.findings)
    for topic, name in moved.items():
        text = f"the log has a topic {topic} of another type: ours is {name}"
        yield Finding("TOPIC_MOVED", text, name)
    if bad := bad_poses(recording):
        text = f"poses with NaN or a zero quaternion (no /tf): {bad:,}"
        yield Finding("NOT_FINITE", text, cases=("base",))
    untimed = 0 if plan.style.needs_contact_states else recording.untimed_messages
    foreign = recording.foreign_states
    unknown, unweighed = counts["support_unknown"], counts["support_unweighed"]
    for count, code, what in (
        (untimed, "STATES_IGNORED", "contacts without a physics step (taken as one step)"),
        (foreign, "STATES_IGNORED", "contact states between other bodies (ignored)"),
        (counts["not_finite"], "NOT_FINITE", "contacts with NaN or infinity (not drawn)"),
        (counts["no_position"], "NOT_DRAWN", "contacts without a point (not drawn)"),
        (counts["no_direction"], "NOT_DRAWN", "contacts without a normal (not drawn)"),
        (counts["overflow"], "NOT_FINITE", _OVERFLOW),
        (unknown, "NO_SUPPORT_DRAWN", f"{_NO_POLYGON} (contact of some foot unknown)"),
        (unweighed, "NO_SUPPORT_DRAWN", f"{_NO_PRESSURE} (vertical forces unknown)"),
    ):
        if count:
            yield Finding(code, f"{what}: {count:,}")


_OVERFLOW = "contacts whose force squared overflows (not drawn, as live)"
_NO_POLYGON = "/support messages without a polygon"
_NO_PRESSURE = "/support messages without a centre of pressure"
