"""Every kind of log that there is truth for."""

from itertools import chain

from tests.truth import (
    attack_cases,
    combined_cases,
    fault_cases,
    foot_cases,
    gait_cases,
    habit_cases,
    other_cases,
    pose_cases,
)
from tests.truth.judging import Case


def groups() -> dict[str, tuple[Case, ...]]:
    """Return all cases by subject, in the order of the page."""
    return {
        "Robots and sampling rates": tuple(gait_cases.robots_and_rates()),
        "Symmetrical gaits: Hildebrand's grid": tuple(gait_cases.hildebrand()),
        "Asymmetrical gaits": tuple(gait_cases.asymmetrical()),
        "Two and six feet": tuple(gait_cases.other_numbers_of_feet()),
        "Short logs and slow ones": tuple(gait_cases.short_and_slow()),
        "Force sensors": tuple(fault_cases.sensors()),
        "Slopes and frames of the wrenches": tuple(fault_cases.slopes()),
        "Worlds": tuple(fault_cases.worlds()),
        "Poses at fault": tuple(pose_cases.faults()),
        "Sound poses": tuple(pose_cases.sound()),
        "Some feet have sensors": tuple(foot_cases.some()),
        "Several sensors of a foot": tuple(foot_cases.several()),
        "Filtered forces": tuple(foot_cases.filters()),
        "Contact flags": tuple(foot_cases.flags()),
        "Scuffs, payloads, treadmills": tuple(foot_cases.others()),
        "Clocks and stamps": tuple(fault_cases.clocks()),
        "Lost messages and silence": tuple(fault_cases.losses()),
        "Mass": tuple(fault_cases.masses()),
        "Units and scales": tuple(fault_cases.scales()),
        "No steps": tuple(other_cases.no_steps()),
        "Light and heavy robots, several faults": tuple(attack_cases.light_and_heavy()),
        "Hexapods": tuple(attack_cases.hexapods()),
        "Slopes across": tuple(attack_cases.slopes_across()),
        "Clocks and losses together": tuple(attack_cases.clocks_and_losses()),
        "Swinging legs": tuple(attack_cases.swinging_legs()),
        "Faults that contradict": tuple(attack_cases.contradictory()),
        "Sensors that stop": tuple(combined_cases.stopped()),
        "Noise that looks like steps": tuple(combined_cases.noisy()),
        "Found by trying at random": tuple(combined_cases.combined()),
        "Some feet only": tuple(habit_cases.some_feet()),
        "Forces flat on top": tuple(habit_cases.flat_tops()),
        "Levels that move": tuple(habit_cases.moving_levels()),
        "Transforms of other legs": tuple(habit_cases.transforms()),
        "Other axes": (*habit_cases.axes(), *habit_cases.sides(), *habit_cases.drifting_height()),
        "No foot on the ground": tuple(attack_cases.in_the_air()),
        "A walk, and then": tuple(other_cases.sequences()),
    }


def all_cases() -> tuple[Case, ...]:
    """Return all cases, in the order of the page."""
    return tuple(chain.from_iterable(groups().values()))
