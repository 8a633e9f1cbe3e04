"""Which robot arm, and what is wrong with it: the keywords of the simulated robot."""

from dataclasses import dataclass

from firmware_sim.plants.options import choice, option, refuse_wrong_options


@dataclass(eq=False, kw_only=True)
class RobotOptions:
    """What the simulated robot is built with.

    Parameters
    ----------
    arm : "irb140" or "kuka"
        An ABB IRB140, or a larger arm of the size of a KUKA KR 240.
    seed : int
        Which arm of that kind: stiffness, backlash, friction, masses and the servo's gravity model are drawn from it.
    spread : float, 1
        Scales how far arms of one kind differ; 0 for the nominal one.
    compliance, orthogonal, backlash, friction, noise : float, 1
        Scale the joints' compliance about their axes and across them, backlash, friction, and the noise of angle and
        torque.
    stiction : float, 1
        Friction at break-away over that of sliding.
    stribeck : float, rad/s
        Speed over which it falls from one to the other.
    load_friction : float, 1
        By what sliding friction grows with the torque in a gear.
    link_friction : float, 1
        Part of sliding friction that is the link's own, beyond the gear and its backlash, and drags it.
    cold : float, 1
        By what part viscous friction is larger in a cold joint; it falls by 1/e for each `warmth`.
    warmth : float, 1
        Of all joints at first.
    heating : float, 1/kJ
        What the work of friction adds to that.
    cooling : float, s
        Time constant with which it is lost.
    hardening : float, 1
        Relative growth of a joint's stiffness from no load to its torque limit.
    payload : float, kg, at the tool point
    tool : float, m, from flange to tool point along the flange's axis
    """

    arm: str = choice("irb140", "kuka")
    seed: int = option(1, "", 0)
    spread: float = option(1.0, "1", 0.0, 2.0)
    compliance: float = option(1.0, "1", 0.1, 10.0)
    orthogonal: float = option(1.0, "1", 0.0, 10.0)
    backlash: float = option(1.0, "1", 0.0, 20.0)
    friction: float = option(1.0, "1", 0.0, 5.0)
    noise: float = option(1.0, "1", 0.0, 100.0)
    stiction: float = option(1.25, "1", 1.0, 3.0)
    stribeck: float = option(0.02, "rad/s", 1e-3, 1.0)
    load_friction: float = option(0.0, "1", 0.0, 0.2)
    link_friction: float = option(0.0, "1", 0.0, 0.9)
    cold: float = option(0.0, "1", 0.0, 5.0)
    warmth: float = option(0.0, "1", 0.0, 10.0)
    heating: float = option(0.0, "1/kJ", 0.0, 10.0)
    cooling: float = option(1800.0, "s", 10.0, 1e5)
    hardening: float = option(0.0, "1", 0.0, 5.0)
    payload: float = option(3.0, "kg", 0.0, 300.0)
    tool: float = option(0.1, "m", 0.0, 1.0)

    def __post_init__(self) -> None:
        """Refuse what is out of range."""
        refuse_wrong_options(self)
