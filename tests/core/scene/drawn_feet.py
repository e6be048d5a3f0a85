"""Feet as they are drawn, made of a few messages."""

import math
from collections.abc import Sequence

import numpy as np

from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import foot_history
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.scene.feet import DrawnFoot, drawn_foot

MS = 1_000_000
NOWHERE = (math.nan, math.nan, math.nan)
RULE = ContactRule(on_n=10.0, off_n=4.0, debounce_s=0.020)
Point = tuple[float, float, float]
Message = tuple[float, float, Point]
"""When, ms; the vertical force, N; the contact point, m."""


def samples_of(messages: Sequence[Message], number: int = 0) -> Samples:
    time = np.array([round(time * MS) for time, _, _ in messages], np.int64)
    force = np.array([force for _, force, _ in messages], np.float64)
    touching = np.isnan(force) | (force > 0.0)
    position = np.array([point for _, _, point in messages], np.float64).reshape(-1, 3)
    return Samples(
        foot=np.full(len(time), number),
        log_time=time,
        stamp=time + 5,
        in_contact=touching,
        force=np.column_stack([np.zeros(len(time)), np.zeros(len(time)), force]),
        in_world=np.ones(len(time), np.bool_),
        points=(touching & np.isfinite(position[:, 0])).astype(np.int64),
        position=np.where(touching[:, None], position, np.nan),
        normal=np.full((len(time), 3), np.nan),
    )


def foot_of(
    messages: Sequence[Message],
    rule: ContactRule = RULE,
    *,
    number: int = 0,
    contact_known: bool = True,
    has_force: bool = True,
) -> DrawnFoot:
    """Measure a foot, and return it as it is drawn."""
    samples = samples_of(messages, number)
    record = foot_history(
        samples, rule, TimeSource.HEADER, force_in_world=False, has_force=has_force
    )
    return drawn_foot(
        number,
        samples,
        record,
        contact_known=contact_known,
        has_force=has_force,
        force_in_world=False,
    )
