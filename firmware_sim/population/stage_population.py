"""What a draw of a stage says of it, and the keys of a rig file that fit it."""

from typing import Any

import numpy as np

from firmware_sim.plants.milling_disturbance import DEFLECTIONS
from firmware_sim.population.draw import Draw, Population, Quantity
from firmware_sim.population.stages import FAMILIES, KIND, DrawnStage, draw_stage
from firmware_sim.population.streams import Streams

PLANT, CUT = "firmware_sim.population:Stage", "firmware_sim.stage_blocks:Milling"
RATE = 10_000.0
"""samples/s, of a rig file unless it says otherwise."""
DEFLECTED = 0.06, 0.14
"""Of its travel, that the robot gives way in the cut, mean absolute."""


def _keys(drawn: DrawnStage, seed: int, family: str) -> dict[str, Any]:
    """Return what a data sheet tells of it: ranges, and how far volts move a stack."""
    plant, travel = drawn.plant, drawn.travel
    high = plant.stacks[0].voltage[1]
    strokes = np.array([stack.stroke for stack in plant.stacks]) * np.diag(plant.modes.gains()[0])
    span = float(strokes.min())
    room = _rounded(0.05 * travel), _rounded(0.95 * travel)
    middle = _rounded(0.5 * sum(room))
    return {
        "rig.name": f"stage-{seed}",
        "limits.voltage": (0.0, high),
        "limits.voltage_slew": _rounded(150.0 * high),
        "limits.extension": (_rounded(0.02 * span), _rounded(0.92 * span)),
        "limits.extension_slew": _rounded(2_000.0 * span),
        "limits.travel": room,
        "sensors.position": (_rounded(-0.3 * travel), _rounded(1.5 * travel)),
        "sensors.position_speed": _rounded(600.0 * travel),
        "sensors.extension": (_rounded(-0.3 * span), _rounded(1.5 * span)),
        "sensors.extension_speed": _rounded(3_000.0 * span),
        "inner.gain": tuple(_rounded(float(each) / high) for each in strokes),
        "reference.position": (middle,),
        "deflection.on": True,
        "laser.rate": min(plant.laser_rate, RATE),
        "deflection.corner": min(2_000.0, 0.4 * plant.laser_rate),
        "deflection.delay": plant.laser_delay - plant.delay + round(RATE / min(plant.laser_rate, RATE)),
        "session.compare": True,
        "characterisation.excursion": _rounded(0.25 * travel),
        "characterisation.scout": _rounded(0.004 * high),
        "link.origin": middle,
        "simulator.plant": PLANT,
        "simulator.options": {"seed": seed, "family": family},
        "simulator.surroundings": CUT,
        "simulator.surroundings_options": _cut(seed, travel),
    }


def _cut(seed: int, travel: float) -> dict[str, Any]:
    """Return a cut that deflects the robot by a part of the stage's travel."""
    rng = Streams(seed, KIND)("cut")
    direction = str(rng.choice(sorted(DEFLECTIONS)))
    scale = travel * rng.uniform(*DEFLECTED) / DEFLECTIONS[direction]
    return {"direction": direction, "scale": _rounded(scale), "seed": seed}


def _rounded(value: float) -> float:
    """Return a number as a data sheet has it."""
    return float(f"{value:.3g}")


def _quantities(drawn: DrawnStage) -> tuple[Quantity, ...]:
    plant, modes = drawn.plant, drawn.plant.modes
    owner = np.argmax(np.abs(modes.extension), axis=0)
    stack = plant.stacks[0]
    each = [tuple(np.round(modes.frequency[owner == axis], 2).tolist()) for axis in range(3)]
    filters = tuple(_corner(sensor.corner) for sensor in (plant.gauge, plant.capacitive, plant.laser))
    compliance = 1e6 * np.sum((modes.plate / (2 * np.pi * modes.frequency)) ** 2, axis=1)
    return (
        Quantity("travel", 1e6 * drawn.travel, "um"),
        Quantity("lever", drawn.lever, "1"),
        Quantity("stroke", tuple(1e6 * each.stroke for each in plant.stacks), "um"),
        Quantity("voltage", stack.voltage[1], "V"),
        Quantity("gain from hysteresis", 100 * drawn.change, "+-%"),
        Quantity("creep", drawn.creep),
        Quantity("amplifier", stack.amplifier, "Hz"),
        Quantity("second lag", _corner(stack.lag), "Hz"),
        Quantity("structure", drawn.structure),
        *(Quantity(f"modes of {name}", found, "Hz") for name, found in zip("xyz", each, strict=True)),
        Quantity("damping", (100 * float(modes.damping.min()), 100 * float(modes.damping.max())), "%"),
        Quantity("compliance", tuple(compliance.tolist()), "um/N"),
        Quantity("filters of gauge, plate, laser", filters, "Hz"),
        Quantity("noise of gauge, plate, laser", tuple(
            1e9 * sensor.noise for sensor in (plant.gauge, plant.capacitive, plant.laser)
        ), "nm"),
        Quantity("delay of plate, laser", (plant.delay, plant.laser_delay), "samples"),
        Quantity("laser's rate", plant.laser_rate, "Hz"),
    )  # fmt: skip


def _corner(corner: float) -> float | str:
    """Return the corner of a low-pass, Hz, or that there is none."""
    return corner if np.isfinite(corner) else "none"


def _make(family: str, seed: int) -> Draw:
    drawn = draw_stage(seed, family)
    return Draw(KIND, family, seed, _quantities(drawn), _keys(drawn, seed, family))


STAGES = Population(KIND, FAMILIES, _make)
"""Stages."""
