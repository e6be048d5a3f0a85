"""Every kind of log that there is truth for."""

from itertools import chain

from tests.truth import (
    event_cases,
    foot_cases,
    gait_cases,
    imu_cases,
    pose_cases,
    sensor_cases,
    time_cases,
)
from tests.truth.judging import Case


def groups() -> dict[str, tuple[Case, ...]]:
    """Return all cases by subject, in the order of the page."""
    subjects = {
        "Robots and sampling rates": gait_cases.robots_and_rates,
        "Symmetrical gaits: Hildebrand's grid": gait_cases.hildebrand,
        "Asymmetrical gaits": gait_cases.asymmetrical,
        "Two and six feet": gait_cases.other_numbers_of_feet,
        "Short logs and slow ones": gait_cases.short_and_slow,
        "Levels without load": sensor_cases.levels,
        "Noise, spikes, limits": sensor_cases.noises,
        "Light and heavy robots, several faults": sensor_cases.light_and_heavy,
        "Hexapods": sensor_cases.hexapods,
        "Slopes and frames of the wrenches": sensor_cases.slopes,
        "Masses and units": sensor_cases.masses_and_units,
        "Swinging legs": sensor_cases.swinging_legs,
        "Faults that contradict": sensor_cases.contradictory,
        "Sensors that stop": sensor_cases.stopped,
        "Some feet have sensors": foot_cases.some,
        "Several sensors of a foot": foot_cases.several,
        "Filtered forces": foot_cases.filters,
        "Contact flags": foot_cases.flags,
        "Scuffs, payloads, treadmills": foot_cases.others,
        "Worlds": pose_cases.worlds,
        "Other axes": pose_cases.axes,
        "Poses at fault": pose_cases.faults,
        "Sound poses": pose_cases.sound,
        "Clocks and stamps": time_cases.clocks,
        "Lost messages and silence": time_cases.losses,
        "No steps": event_cases.no_steps,
        "No foot on the ground": event_cases.in_the_air,
        "A walk, and then": event_cases.sequences,
        "Changes of the gait": event_cases.gait_changes,
        "Events": event_cases.planned,
        "Falls, and what looks like one": event_cases.falls,
        "Accelerometers": imu_cases.sound,
        "Accelerometers at fault": imu_cases.odd,
    }
    return {name: tuple(cases()) for name, cases in subjects.items()}


def all_cases() -> tuple[Case, ...]:
    """Return all cases, in the order of the page."""
    return tuple(chain.from_iterable(groups().values()))
