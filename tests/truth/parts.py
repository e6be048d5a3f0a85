"""Robots made of links: as a model of a physics engine (MuJoCo), and as a robot description."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

AXES: Final = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1", "down": "0 0 -1"}


@dataclass(frozen=True, slots=True)
class Part:
    """A link, and the joint on which it hangs."""

    name: str
    parent: str = ""
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, of the joint in the parent."""
    axis: str = ""
    """One of `AXES`; empty: the joint is fixed."""
    kg: float = 0.0
    shape: str = ""
    """As the engine calls it; also `size`."""
    size: tuple[float, ...] = ()
    centre_m: float = 0.0
    """Of the shape over the joint."""
    touches: bool = False
    """Whether the ground stops it."""
    kind: str = "revolute"
    follows: str = ""
    """Joint of which it turns back twice the angle."""

    @property
    def joint(self) -> str:
        """Name of its joint."""
        return f"{self.name}_joint"


def model_xml(
    parts: Sequence[Part],
    free: str,
    height_m: float,
    gain: tuple[float, float],
    integrator: str = "Euler",
) -> str:
    """Return a model in which a motor holds each joint at an angle.

    Args:
        parts: the first is the trunk.
        free: how the trunk may move: joints of the engine.
        height_m: of the trunk, over the ground at z = 0.
        gain: of the motors, for the angle and for its rate.
        integrator: of the engine; stiff motors need ``implicitfast``.
    """
    motors = "".join(
        f'<position joint="{part.joint}" kp="{gain[0]}" kv="{gain[1]}"/>'
        for part in parts
        if part.axis
    )
    return (
        f'<mujoco><option timestep="0.001" integrator="{integrator}"/><worldbody>'
        '<geom type="plane" size="50 50 1" friction="1 .01 .001"/>'
        f"{_body(replace(parts[0], at=(0.0, 0.0, height_m)), parts, free)}"
        f"</worldbody><actuator>{motors}</actuator></mujoco>"
    )


def _body(part: Part, parts: Sequence[Part], joint: str = "") -> str:
    """Return a body of the engine, what is fixed to it, and those that hang on it."""
    if part.axis:
        joint = f'<joint name="{part.joint}" axis="{AXES[part.axis]}" armature=".01"/>'
    below = [each for each in parts if each.parent == part.name and each.kg]
    fixed = (_shape(each, each.at) for each in below if not each.axis)
    hanging = (_body(each, parts) for each in below if each.axis)
    return (
        f'<body name="{part.name}" pos="{_words(part.at)}">{joint}{_shape(part)}'
        f"{''.join(fixed)}{''.join(hanging)}</body>"
    )


def _shape(part: Part, at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> str:
    contact = 'contype="0" conaffinity="0"'
    if part.touches:
        contact = 'friction="1 .01 .001" solref=".004 1"'
    return (
        f'<geom name="{part.name}" type="{part.shape}" size="{_words(part.size)}" '
        f'pos="{at[0]} {at[1]} {at[2] + part.centre_m}" mass="{part.kg}" {contact}/>'
    )


def urdf(parts: Sequence[Part]) -> str:
    """Return the robot description."""
    links = "".join(f'<link name="{part.name}">{_inside(part)}</link>' for part in parts)
    joints = "".join(
        f'<joint name="{part.joint}" type="{part.kind if part.axis else "fixed"}">'
        f'<parent link="{part.parent}"/><child link="{part.name}"/>'
        f'<origin xyz="{_words(part.at)}"/>{_moves(part)}</joint>'
        for part in parts
        if part.parent
    )
    return f'<robot name="robot">{links}{joints}</robot>'


def _inside(part: Part) -> str:
    """Return the mass of a link, and its shape where that is a round foot."""
    if not part.kg:
        return ""
    centre = f'<origin xyz="0 0 {part.centre_m}"/><mass value="{part.kg}"/>'
    ball = f'<collision><geometry><sphere radius="{part.size[0]}"/></geometry></collision>'
    is_ball = part.touches and part.shape == "sphere"
    return f"<inertial>{centre}</inertial>{ball if is_ball else ''}"


def _moves(part: Part) -> str:
    if not part.axis:
        return ""
    follows = f'<mimic joint="{part.follows}" multiplier="-2"/>' if part.follows else ""
    limit = '<limit lower="-3" upper="3" effort="300" velocity="30"/>'
    return f'<axis xyz="{AXES[part.axis]}"/>{limit}{follows}'


def _words(numbers: Iterable[float]) -> str:
    return " ".join(f"{number:.9g}" for number in numbers)
