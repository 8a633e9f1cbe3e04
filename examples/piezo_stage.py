"""The simulated piezo stage and the cut that disturbs it, as four figures: loops, creep, frequency responses, a cut.

Run it:  python examples/piezo_stage.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from firmware_sim.plants.milling_disturbance import MillingDisturbance
from firmware_sim.plants.piezo_stage import PiezoStagePlant
from firmware_sim.plants.piezo_stage_modes import PIEZO_STIFFNESS
from rigkit.figure_style import styled

RATE = 10_000.0
AXES = "xyz"


def moved(voltage: np.ndarray) -> np.ndarray:
    """Return what the strain gauges of a new stage read under a voltage on all axes, shape (samples, 3), m."""
    drive = np.repeat(voltage[:, None], 3, axis=1)
    rest, (extension, position, absolute) = np.zeros_like(drive), np.zeros((3, *drive.shape))
    PiezoStagePlant(RATE).run(drive, rest, rest, extension, position, absolute)
    return extension


def loops() -> Figure:
    """Draw extension over voltage: triangles of changing amplitude, and one amplitude at three rates."""
    figure = Figure()
    amplitudes, rates = figure.subplots(1, 2, sharey=True)
    corners = [0, 1000, 0, 800, 100, 600, 250, 500, 350, 450, 400]
    voltage = np.concatenate([np.linspace(a, b, 5_000) for a, b in zip(corners[:-1], corners[1:], strict=True)])
    amplitudes.plot(voltage, 1e6 * moved(voltage)[:, 2])
    amplitudes.set(xlabel="voltage (V)", ylabel="extension (µm)", title="z, triangle of 1 Hz, decreasing amplitude")
    for frequency in (1, 10, 40):
        time = np.arange(round(3 * RATE)) / RATE
        voltage = 500 - 200 * np.cos(2 * np.pi * frequency * time) * np.minimum(time, 1)
        last = slice(-round(RATE / frequency) - 1, None)
        rates.plot(voltage[last], 1e6 * moved(voltage)[last, 2], label=f"{frequency} Hz")
    rates.set(xlabel="voltage (V)", title="z, sine of 200 V amplitude")
    rates.legend()
    return figure


def creep() -> Figure:
    """Draw extension after a ramp of 1 s to mid-range."""
    figure = Figure()
    axes = figure.subplots()
    time = np.arange(-round(RATE), round(60 * RATE)) / RATE
    extension = moved(np.clip(500 + 500 * time, 0, 500))
    shown = slice(round(2 * RATE), None, 100)
    for axis, name in enumerate(AXES):
        axes.plot(time[shown], 1e6 * (extension[shown, axis] - extension[shown, axis][0]), label=name)
    axes.plot([10, 40], [0.7, 0.7 + 30 * 0.02], "k--", label="0.02 µm/s")
    axes.set(xlabel="time at 500 V (s)", ylabel="extension since 1 s (µm)")
    axes.legend()
    return figure


def responses() -> Figure:
    """Draw what plate and gauges do per free expansion, mode by mode."""
    figure = Figure(figsize=(8.0, 5.0))
    upper, lower = figure.subplots(2, 1, sharex=True)
    modes = PiezoStagePlant(RATE).modes
    frequency = np.geomspace(5, 3000, 3000)
    omega, natural = 2 * np.pi * frequency[:, None], 2 * np.pi * modes.frequency
    answers = PIEZO_STIFFNESS / (natural**2 - omega**2 + 2j * modes.damping * natural * omega)
    for axis, name in enumerate(AXES):
        upper.loglog(frequency, np.abs(answers @ (modes.plate[axis] * modes.extension[axis])), label=name)
        lower.loglog(frequency, np.abs(answers @ modes.extension[axis] ** 2), label=name)
    upper.loglog(frequency, np.abs(answers @ (modes.plate[2] * modes.extension[0])), "k:", label="z from x")
    upper.set(ylabel="plate (m/m)", title="Gain from the free expansion of the stack")
    lower.set(xlabel="frequency (Hz)", ylabel="extension (m/m)")
    upper.legend()
    return figure


def cut() -> Figure:
    """Draw the robot's deflection in each cut, and the force of one."""
    figure = Figure(figsize=(8.0, 5.0))
    upper, lower = figure.subplots(2, 1)
    for axis, name in enumerate(AXES):
        milling = MillingDisturbance(RATE, direction=name)
        force, base = np.zeros((2, round(22 * RATE), 3))
        milling.run(force, base)
        time = np.arange(len(base)) / RATE
        error = 1e6 * np.mean(np.abs(base[milling.cut, axis]))
        upper.plot(time[::20], 1e6 * base[::20, axis], label=f"{name}: mean absolute {error:.1f} µm")
    shown = slice(round(5 * RATE), round(5.02 * RATE))
    lower.plot(time[shown], force[shown], label=list(AXES))
    upper.set(xlabel="time (s)", ylabel="deflection (µm)")
    lower.set(xlabel="time (s)", ylabel="force, milling z (N)")
    upper.legend()
    lower.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
    return figure


def main(folder: Path) -> None:
    """Write the figures."""
    folder.mkdir(parents=True, exist_ok=True)
    with styled():
        for draw in (loops, creep, responses, cut):
            file = folder / f"{draw.__name__}.png"
            draw().savefig(file)
            print(file)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "piezo-stage"))
