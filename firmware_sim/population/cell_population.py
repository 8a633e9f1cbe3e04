"""What a draw of a robot cell says of it, and the keys of the cell's file that fit it."""

from typing import Any

import numpy as np

from firmware_sim.population.cells import HOME, KIND, SEGMENT_HOME, TOOL, DrawnCell, draw_cell
from firmware_sim.population.cuts import DEPTH, FAMILIES
from firmware_sim.population.draw import Draw, Population, Quantity
from firmware_sim.population.pair_population import PAIRS

BLOCKS = "firmware_sim.population"
RUBBING = {
    "stiction": "1", "stribeck": "rad/s", "load_friction": "1", "cold": "1", "warmth": "1", "heating": "1/kJ",
    "cooling": "s",
}  # fmt: skip
"""Keywords of `RobotOptions` about friction, and their units."""
SEGMENT_DEPTH = 0.5 * DEPTH
"""m: a tool that has plunged cuts all around it, twice as much as in a slot."""
OVERLOAD, MOST = 8.0, 300.0
"""Of the force wanted, at which a tool retreats, and N at most."""
TOUCH, PRESSED = 4.0, 4.0
"""Of the force sensor's noise, from which on the tool touches, and of that, what is wanted at least."""


def _keys(drawn: DrawnCell, seed: int, family: str) -> dict[str, Any]:
    """Return what a user knows: noise by data sheets, how stiff the robot is, what force a material takes."""
    machine, piece = {"seed": seed, "family": family}, {"cell": seed, "family": family}
    noise = drawn.tracker["noise"]
    contact = max(1.0, TOUCH * drawn.sensor["noise"])
    wanted = max(drawn.cut.force * SEGMENT_DEPTH / DEPTH, PRESSED * contact)
    compliance = np.diag(drawn.robot.compliance(SEGMENT_HOME, TOOL))[:2]
    own = {
        "rig.name": f"cell-{seed}",
        "tracker.jump": max(5e-4, _rounded(8.0 * noise)),
        "tracker.residual": max(5e-4, _rounded(5.0 * noise)),
        "segments.depth": SEGMENT_DEPTH,
        "force.force": _rounded(wanted),
        "force.stiffness": _rounded(1.0 / float(compliance.mean())),
        "force.force_noise": _rounded(drawn.sensor["noise"]),
        "force.contact": _rounded(contact),
        "force.overload": _rounded(min(OVERLOAD * wanted, MOST)),
        "simulator.options": machine,
        "simulator.clamped": f"{BLOCKS}:ClampedArm",
        "plants.robot": f"{BLOCKS}:Robot",
        "plants.pocket": f"{BLOCKS}:Cut",
        "plants.pocket_options": piece,
        "plants.tracker": f"{BLOCKS}:Tracker",
        "plants.tracker_options": machine,
        "plants.force_sensor": f"{BLOCKS}:ForceSensor",
        "plants.force_sensor_options": machine,
        "plants.cut_options": {"seed": seed, "force": _rounded(drawn.toroid)},
        "feed_plants.cut": f"{BLOCKS}:Cut",
        "feed_plants.cut_options": piece,
    }
    pair = PAIRS.draw(seed).keys
    return own | {key: value for key, value in pair.items() if key.startswith("midranging.")}


def _rounded(value: float) -> float:
    """Return a number as a data sheet has it."""
    return float(f"{value:.3g}")


def _quantities(drawn: DrawnCell) -> tuple[Quantity, ...]:
    return (*_robot(drawn), *_cut(drawn), *_sensors(drawn))


def _robot(drawn: DrawnCell) -> tuple[Quantity, ...]:
    robot, arm, guided = drawn.robot, drawn.robot.arm, drawn.robot.guided
    compliance = 1e6 * np.diag(robot.compliance(HOME, TOOL))
    return (
        Quantity("compliance about the axes, over its kind's", arm["compliance"], "1"),
        Quantity("compliance across the axes, over its kind's", arm["orthogonal"], "1"),
        Quantity("compliance of the tool, x y z", tuple(compliance.tolist()), "um/N"),
        Quantity("spindle on that across the axes", tuple(robot.rings_at(HOME, TOOL).tolist()), "Hz"),
        Quantity("growth of stiffness", arm["hardening"], "1"),
        Quantity("backlash, over 0.1 mrad", arm["backlash"], "1"),
        Quantity("friction", robot.friction),
        Quantity("friction over its kind's", arm["friction"], "1"),
        *(Quantity(name.replace("_", " "), arm[name], unit) for name, unit in RUBBING.items() if name in arm),
        Quantity("payload", arm["payload"], "kg"),
        Quantity("gear error", guided["gear_error"], "1"),
        Quantity("filter of guided motion", guided["filter"], "Hz"),
        Quantity("delay of guided motion", guided["delay"], "cycles"),
    )  # fmt: skip


def _cut(drawn: DrawnCell) -> tuple[Quantity, ...]:
    """Return what there is of a cut: nothing of knots in metal."""
    drawn_cut, cut = drawn.cut, drawn.cut.cut
    mode, hardness, law = cut.mode, cut.hardness, cut.law
    found = [
        Quantity("slot of 2 mm at 10 mm/s", drawn_cut.force, "N"),
        Quantity("radial over tangential", law.strength[1] / law.strength[0], "1"),
        Quantity("teeth", len(cut.wobble)),
        Quantity("spindle", cut.spindle, "Hz"),
        Quantity("full cut in steel", drawn.toroid, "N"),
    ]
    if drawn_cut.rubbing:
        found.append(Quantity("part of it that rubs", drawn_cut.rubbing, "1"))
    if any(law.power):
        found.append(Quantity("Kienzle's power", law.power[0], "1"))
    if any(cut.wobble):
        found.append(Quantity("teeth stand out by", 1e6 * float(np.ptp(cut.wobble)), "um"))
    if mode is not None:
        found += [
            Quantity("tool's mode, x y", mode.frequency, "Hz"),
            Quantity("its damping", tuple(100 * each for each in mode.damping), "%"),
            Quantity("its stiffness", tuple(1e-6 * each for each in mode.stiffness), "N/um"),
            Quantity("depth over the limit of chatter", drawn_cut.over_limit, "1"),
        ]
    if hardness.grain:
        found += [Quantity("grain", hardness.grain, "1"), Quantity("knots", hardness.knots)]
        found.append(Quantity("knots harder by", hardness.knot, "1"))
    if len(hardness.boards) > 1:
        found.append(Quantity("boards harder than the first by", tuple(hardness.boards[1:]), "1"))
    return tuple(found)


def _sensors(drawn: DrawnCell) -> tuple[Quantity, ...]:
    tracker, sensor = drawn.tracker, drawn.sensor
    return (
        Quantity("tracker's noise", 1e6 * tracker["noise"], "um"),
        Quantity("tracker's warp", 1e6 * tracker["warp"], "um"),
        Quantity("tracker's samples lost", 100 * tracker["lost"], "%"),
        Quantity("force sensor's noise", sensor["noise"], "N"),
        Quantity("force sensor's drift", sensor["drift"], "N/min"),
        Quantity("force sensor's crosstalk", 100 * sensor["crosstalk"], "%"),
    )


def _make(family: str, seed: int) -> Draw:
    drawn = draw_cell(seed, family)
    return Draw(KIND, family, seed, _quantities(drawn), _keys(drawn, seed, family))


CELLS = Population(KIND, FAMILIES, _make)
"""Robot cells."""
