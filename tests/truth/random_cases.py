"""Measure logs with faults in random combinations, and print what is wrong.

    python -m tests.truth.random_cases 0 400

Each number is a robot, a gait, sensors and up to three faults. What it prints is to be judged by a
person: tolerances are coarse, and some combinations hide a fault from any program (forces without
contact points do not show that the odometry drifts). What is a fault of ours becomes a case of
`combined_cases.py`.
"""

import random
import sys
import tempfile
from collections.abc import Callable, Mapping
from math import radians
from pathlib import Path
from typing import Final

import click

from tests.truth import gaits
from tests.truth import sensor_faults as sensor
from tests.truth import time_faults as time
from tests.truth import world_faults as world
from tests.truth.attack_cases import COARSE
from tests.truth.judging import Case, faults, judge
from tests.truth.outcome import outcome
from tests.truth.recorders import FORCE, recorder
from tests.truth.recording import Disturbance
from tests.truth.robots import Robot, biped, hexapod, quadruped
from tests.truth.walking import Walk

Choose = Callable[[random.Random, Walk, float], Disturbance]
"""Makes a fault of a walk whose feet carry so many N each on average."""
GAITS: Final[Mapping[Callable[[float], Robot], tuple[gaits.Gait, ...]]] = {
    biped: (gaits.BIPED_WALK,),
    quadruped: (gaits.TROT, gaits.WALK, gaits.PACE, gaits.BOUND, gaits.TRANSVERSE_GALLOP),
    hexapod: (gaits.WAVE, gaits.TRIPOD, gaits.TETRAPOD),
}
FORCE_FAULTS: Final[Mapping[str, Choose]] = {
    "offset": lambda pick, _, load: sensor.offset(load * pick.uniform(-1.5, 1.0)),
    "one offset": lambda pick, walk, load: sensor.offset(
        load * pick.uniform(-1.0, 0.5), walk.robot.feet[0]
    ),
    "drift": lambda pick, _, load: sensor.drift(load * pick.uniform(-1.0, 1.0)),
    "lone zeros": lambda pick, _, __: sensor.lone_zeros(0.01, seed=pick.randrange(99)),
    "wobble": lambda pick, _, load: sensor.wobble(load * pick.uniform(0.02, 0.15)),
}
FAULTS: Final[Mapping[str, Choose]] = {
    "spikes": lambda pick, _, load: sensor.spikes(load * pick.choice((8.0, -8.0, 20.0)), 2.0),
    "quantised": lambda pick, _, load: sensor.quantised(load * pick.choice((0.01, 0.05))),
    "saturated": lambda _, __, load: sensor.saturated(1.2 * load),
    "stuck": lambda pick, walk, load: sensor.stuck(
        load * pick.choice((0.0, 0.6)), walk.robot.feet[-1]
    ),
    "no numbers": lambda pick, _, __: sensor.not_finite(0.01, seed=pick.randrange(99)),
    "other mass": lambda pick, walk, _: sensor.wrong_mass(
        pick.choice((None, 0.7 * walk.robot.mass_kg, 1.4 * walk.robot.mass_kg))
    ),
    "lost": lambda pick, _, __: time.lost(pick.choice((0.02, 0.08)), seed=pick.randrange(99)),
    "late clock": lambda pick, _, __: time.late_clock(pick.choice((0.1, -0.2, 0.3))),
    "jitter": lambda pick, _, __: time.late_delivery(0.01, 0.02, seed=pick.randrange(99)),
    "bursts": lambda _, __, ___: time.in_bursts(0.1),
    "jump": lambda pick, walk, _: world.jump(
        walk.seconds / 2.0, (pick.choice((0.5, -1.0)), 0.3, 0.0)
    ),
    "drifting": lambda pick, _, __: world.drifting(pick.choice((0.05, 0.15))),
    "displaced": lambda pick, _, __: world.displaced((pick.choice((0.2, 3.0)), 1.0, 0.0)),
    "pose noise": lambda pick, _, __: world.pose_noise(pick.choice((0.001, 0.003))),
    "from zero": lambda _, __, ___: world.base_from_zero,
}
UNKNOWN: Final = {
    "spikes": ("peak force",),
    "other mass": ("impulse",),
    "saturated": ("peak force", "load share"),
    "jump": ("path", "speed", "stride length", "froude"),
}
"""Figures whose truth a fault changes."""


def random_case(seed: int) -> Case:
    """Return the case of a number."""
    pick = random.Random(seed)  # noqa: S311 - no secret
    walk, rate_hz = _walk(pick)
    load = walk.robot.mass_kg * 9.81 / len(walk.robot.feet)
    kind = pick.choice(("bumpers", "force sensors", "silent in swing", "link forces"))
    disturbances: list[Disturbance] = []
    faults_of_kind = dict(FAULTS)
    if kind == "force sensors":
        noise = load * pick.choice((0.005, 0.02, 0.04))
        disturbances += [FORCE, sensor.noise(noise, seed=seed)]
        faults_of_kind |= FORCE_FAULTS
    elif kind == "silent in swing":
        disturbances.append(time.silent_in_swing)
    elif kind == "link forces":
        disturbances.append(sensor.in_link_frame)
    names = pick.sample(list(faults_of_kind), pick.choice((0, 1, 1, 2, 2, 3)))
    disturbances += [faults_of_kind[name](pick, walk, load) for name in names]
    skipped = {"verdict", *(figure for name in names for figure in UNKNOWN.get(name, ()))}
    return Case(
        f"{seed}: {kind}, {rate_hz:g} Hz, {walk}, {names}",
        recorder(walk, *disturbances, rate_hz=rate_hz),
        cause=".",
        tolerance=COARSE,
        shifted="late clock" in names,
        skip=tuple(skipped),
    )


def _walk(pick: random.Random) -> tuple[Walk, float]:
    robot = pick.choice(list(GAITS))
    rate_hz = pick.choice((50.0, 100.0, 200.0, 500.0))
    period_s = pick.uniform(0.45 if rate_hz > 60.0 else 0.8, 1.6)
    walk = Walk(
        gait=pick.choice(GAITS[robot]),
        robot=robot(10.0 ** pick.uniform(-0.3, 1.95)),
        period_s=round(period_s, 2),
        speed_mps=round(pick.uniform(0.05, 0.7), 2),
        seconds=round(pick.uniform(4.0, 25.0) * max(1.0, period_s), 1),
        slope_rad=radians(pick.choice((0, 0, 0, 5, 12, 20))),
        heading_rad=radians(pick.choice((0, 0, 37, 120, -90))),
        body_yaw_rad=radians(pick.choice((0, 0, 0, 90))),
        hump=pick.choice((0.2, 0.0)),
    )
    return walk, rate_hz


def main(first: int, last: int) -> None:
    """Print what is wrong in the cases of a range of numbers."""
    with tempfile.TemporaryDirectory() as folder:
        for case in map(random_case, range(first, last)):
            recording = case.record()
            found = outcome(recording, Path(folder))
            wrong = [
                each for each in faults(judge(case, recording, found)) if each.status == "wrong"
            ]
            if wrong:
                click.echo(f"{case.name}\n    said: {', '.join(sorted(set(found.warnings())))}")
            for each in wrong:
                click.echo(f"    {each.figure}: {each.truth} -> {each.result} {each.why}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
