"""The report of `calibrate milling`: responses of the robot, forces and deflections beside their models."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from calibration.milling.process_fit import ProcessFit
from calibration.milling.session import Calibrated
from rigkit.figure_style import COLOURS, styled
from rigkit.report import Fact, Plot, Report, Section, Table
from stagectl.robot.milling.milling_models import SIDES

AXES = ("x", "y", "z")
FIT_HEAD = ("model", "x", "y", "z")
SIDE_WORDS = {"motors": "G_R to the motors' angles", "tool": "G_R to the tool, by the tracker"}


def fit_rows(found: Calibrated) -> list[tuple[str, ...]]:
    """Return the fits on validation data, as text under `FIT_HEAD`."""
    rows = [(SIDE_WORDS[side], found.models.robot[side].fresh) for side in SIDES]
    for force, process in found.models.process.items():
        rows.append((f"G_M, {force} force", process.force_fresh))
        rows.append((f"G_K, {force} force", process.compliance_fresh))
    told = [(name, *(f"{each:.1f}" for each in fresh)) for name, fresh in rows]
    joints = 100 * found.torques.fit
    told.append(("gravity and friction, joints 1 to 3", *(f"{each:.1f}" for each in joints[:3])))
    told.append(("gravity and friction, joints 4 to 6", *(f"{each:.1f}" for each in joints[3:])))
    return told


def figures(found: Calibrated) -> dict[str, Any]:
    """Return what was found, other programs' keys: fits in %, errors in m."""
    models = found.models
    return {
        "robot": {side: {"fresh": robot.fresh.tolist()} for side, robot in models.robot.items()},
        "process": {
            force: {"force": process.force_fresh.tolist(), "compliance": process.compliance_fresh.tolist()}
            for force, process in models.process.items()
        },
        "torques": {name: getattr(found.torques, name).tolist() for name in ("fit", "inside", "inertia")},
        "mae": {each.name: each.mae.tolist() for each in (*found.free, found.milled)},
    }


def milling_report(found: Calibrated, source: str) -> Report:
    """Make the report.

    Parameters
    ----------
    found : Calibrated
    source : str
        What it is called by.
    """
    table = Table(FIT_HEAD, tuple(fit_rows(found)))
    facts = tuple(
        Fact(f"MAE norm, {each.name}", f"{1e6 * np.linalg.norm(each.mae):.0f} µm")
        for each in (found.free[0], found.free[-1], found.milled)
    )
    fits = Section("Fits", "NRMSE on validation data, %.", tables=(table,))
    with styled():
        return Report("How the robot mills", source, facts, (fits, *_sections(found)))


def _sections(found: Calibrated) -> Iterator[Section]:
    yield Section("Friction", plots=(_friction(found),))
    yield Section("Robot", plots=tuple(_response(found, side) for side in SIDES))
    for force, fit in found.processes.items():
        yield Section(f"Force, {force}", plots=(_beside(fit, fit.force, fit.force_model, 1.0, "N", "G_M"),))
        plot = _beside(fit, fit.deflection, fit.deflection_model, 1e6, "µm", "G_K")
        yield Section(f"Deflection, {force} force", plots=(plot,))


def _friction(found: Calibrated) -> Plot:
    """Draw the range of each joint's friction over its speed, both on scales that are linear near rest."""
    speed, low, high = (np.asarray(found.models.torques[f"friction/{name}"]) for name in ("speed", "low", "high"))
    figure = Figure(figsize=(8.0, 5.2))
    for joint, panel in enumerate(figure.subplots(2, 3, sharex=True).flat):
        across = np.degrees(speed[:, joint])
        panel.fill_between(across, low[:, joint], high[:, joint], color=COLOURS[0], alpha=0.35, linewidth=0)
        panel.plot(across, (low[:, joint] + high[:, joint]) / 2, color=COLOURS[0], linewidth=0.9)
        panel.set_xscale("symlog", linthresh=0.1, linscale=0.5)
        panel.set_xticks((-10, -1, 0, 1, 10), ("-10", "-1", "0", "1", "10"))
        panel.set_title(f"joint {joint + 1}")
        if joint % 3 == 0:
            panel.set_ylabel("friction, N m")
        if joint >= 3:
            panel.set_xlabel("speed, °/s")
    return Plot(figure, "What friction may be at a speed, seen from the joint, and the middle of it.")


def _response(found: Calibrated, side: str) -> Plot:
    robot = found.models.robot[side]
    figure = Figure(figsize=(8.0, 4.6))
    size, phase = figure.subplots(2, 1, sharex=True)
    for axis, (name, colour) in enumerate(zip(AXES, COLOURS, strict=False)):
        model = robot.axes[axis].response(robot.frequency)
        size.semilogx(robot.frequency, np.abs(robot.response[:, axis]), ".", color=colour, markersize=3)
        size.semilogx(robot.frequency, np.abs(model), color=colour, label=name)
        for values, style in ((robot.response[:, axis], "."), (model, "-")):
            turned = np.degrees(np.unwrap(np.angle(values)))
            phase.semilogx(robot.frequency, turned, style, color=colour, markersize=3)
    size.set_ylabel("gain")
    phase.set_ylabel("phase, °")
    phase.set_xlabel("frequency, Hz")
    size.legend(loc="best")
    return Plot(figure, f"{SIDE_WORDS[side]}: measured (dots) and the third-order models (lines).")


def _beside(fit: ProcessFit, measured: np.ndarray, modelled: np.ndarray, scale: float, unit: str, name: str) -> Plot:
    figure = Figure(figsize=(8.0, 5.2))
    for axis, panel in enumerate(figure.subplots(3, 1, sharex=True)):
        panel.plot(fit.time, scale * measured[:, axis], color=COLOURS[0], linewidth=0.9, label="measured")
        panel.plot(fit.time, scale * modelled[:, axis], color=COLOURS[1], linewidth=0.9, label=f"model {name}")
        panel.set_ylabel(f"{AXES[axis]}, {unit}")
        if axis == 0:
            panel.legend(loc="best", ncols=2)
        if axis == 2:
            panel.set_xlabel("time, s")
    return Plot(figure, f"Measured and as {name} has it, about the mean, below 15 Hz.")
