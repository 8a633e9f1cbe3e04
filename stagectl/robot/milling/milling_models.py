"""What `calibrate milling` finds out about a robot that mills, and its file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from calibration.state_space.model import InnovationModel
from calibration.state_space.model_checks import MATRICES
from rigkit.model_file import ModelFile, ModelFileError, read_model_file, write_model_file
from stagectl.robot.milling.axis_model import AxisModel
from stagectl.robot.milling.convergence import Doubt, interpolated
from stagectl.robot.milling.learning import ProcessModel

FORMAT = "vibrostage milling models 1"
SIDES = MOTORS, TOOL = "motors", "tool"
"""Where the robot's answer is seen: by its motors' angles, or by the tracker at the tool."""
FORCES = ("measured", "estimated")
"""Which force a process model belongs to."""
ROBOT = {"numerator": "1", "denominator": "1", "delay": "samples", "frequency": "Hz", "response": "1", "spread": "1"}
"""Arrays of a robot model, and their units."""


@dataclass(frozen=True, eq=False)
class RobotModel:
    """G_R of x, y and z, and what was measured of it.

    Parameters
    ----------
    axes : three AxisModel
    frequency : array, shape (bins,), Hz
    response : complex array, shape (bins, 3), 1
        As measured.
    spread : array, shape (bins, 3), 1
        How far off that may be: twice its standard deviation.
    fresh : array, shape (3,), %
        NRMSE of the free run on a chirp kept for validation.
    """

    axes: tuple[AxisModel, ...]
    frequency: np.ndarray
    response: np.ndarray
    spread: np.ndarray
    fresh: np.ndarray


@dataclass(frozen=True, eq=False)
class Process:
    """G_M and G_K, and how well they fit.

    Parameters
    ----------
    model : ProcessModel
    force_fresh, compliance_fresh : arrays, shape (3,), %
        NRMSE of the free run on the part of the trial kept for validation.
    frequency : array, shape (bins,), Hz
    other : complex array, shape (bins, 3, 3), 1
        G_K G_M of models of the part of the trial that they were fitted to.
    """

    model: ProcessModel
    force_fresh: np.ndarray
    compliance_fresh: np.ndarray
    frequency: np.ndarray
    other: np.ndarray


@dataclass(frozen=True, eq=False)
class MillingModels:
    """All that was found.

    Parameters
    ----------
    robot : mapping of str to RobotModel
        By side, of `SIDES`.
    process : mapping of str to Process
        By force, of `FORCES`; those that were identified.
    depth : float, m
        At which the process was identified.
    torques : mapping of str to array
        Gravity and friction, as `torque_file` has them.
    provenance : mapping of str to str
    """

    robot: Mapping[str, RobotModel]
    process: Mapping[str, Process]
    depth: float
    torques: Mapping[str, np.ndarray] = field(default_factory=dict)
    provenance: Mapping[str, str] = field(default_factory=dict)

    def doubt(self, side: str, force: str | None) -> Doubt:
        """Return what else robot and process may be, for `contraction`.

        Where the tool's answer is not surely another than the motors', by its spread, it is taken as theirs: chirps
        hardly move the tool at their lowest frequencies, where the tracker's noise would leave everything open.

        Parameters
        ----------
        side : str, of `SIDES`
        force : str, of `FORCES`, or None for free space
        """
        robot = self.robot[side]
        response, spread = robot.response, robot.spread
        if side == TOOL:
            motors = self.robot[MOTORS]
            there = interpolated(robot.frequency, motors.frequency, motors.response)
            known = interpolated(robot.frequency, motors.frequency, motors.spread).real
            is_other = np.abs(response - there) > spread
            response, spread = np.where(is_other, response, there), np.where(is_other, spread, known)
        if force is None:
            return Doubt(robot.frequency, response, spread)
        process = self.process[force]
        return Doubt(robot.frequency, response, spread, interpolated(robot.frequency, process.frequency, process.other))


def write_milling(path: Path, models: MillingModels, torque_units: Mapping[str, str]) -> None:
    """Write models to a file, whole or not at all.

    Parameters
    ----------
    path : Path
    models : MillingModels
    torque_units : mapping of str to str
        Units of `models.torques`.
    """
    arrays, units = dict(models.torques), dict(torque_units)
    for side, robot in models.robot.items():
        for name, value in {
            "numerator": np.array([each.numerator for each in robot.axes]),
            "denominator": np.array([each.denominator for each in robot.axes]),
            "delay": np.array([each.delay for each in robot.axes]),
            "frequency": robot.frequency,
            "response": robot.response,
            "spread": robot.spread,
            "fresh": robot.fresh,
        }.items():
            arrays[f"G_R/{side}/{name}"] = value
            units[f"G_R/{side}/{name}"] = ROBOT.get(name, "%")
        arrays[f"G_R/{side}/rate"] = np.array(robot.axes[0].rate)
    for force, process in models.process.items():
        for letter, model, fresh in (
            ("G_M", process.model.force, process.force_fresh),
            ("G_K", process.model.compliance, process.compliance_fresh),
        ):
            where = f"{letter}/{force}"
            arrays |= {f"{where}/{name}": getattr(model, name) for name in MATRICES}
            arrays |= {f"{where}/rate": np.array(model.rate), f"{where}/fresh": fresh}
        arrays |= {f"coupling/{force}/frequency": process.frequency, f"coupling/{force}/response": process.other}
        units[f"coupling/{force}/frequency"] = "Hz"
    arrays["depth"], units["depth"] = np.array(models.depth), "m"
    words = {"sides": list(models.robot), "forces": list(models.process)}
    write_model_file(path, ModelFile(FORMAT, arrays, units, words, models.provenance))


def read_milling(path: Path) -> MillingModels:
    """Read models; torques are left to `torque_file.read_force_model`.

    Raises
    ------
    ModelFileError : not such a file, a damaged one, or arrays that are no models.
    """
    words = read_model_file(path, FORMAT, ["depth"], ["sides", "forces"]).words
    sides, forces = (tuple(each) if not isinstance(each, str) else (each,) for each in words.values())
    names = ["depth", *(f"G_R/{side}/{name}" for side in sides for name in (*ROBOT, "fresh", "rate"))]
    for force in forces:
        names += [f"{each}/{force}/{name}" for each in ("G_M", "G_K") for name in (*MATRICES, "rate", "fresh")]
        names += [f"coupling/{force}/frequency", f"coupling/{force}/response"]
    content = read_model_file(path, FORMAT, names)
    try:
        return MillingModels(
            {side: _robot(content.arrays, f"G_R/{side}") for side in sides},
            {force: _process(content.arrays, force) for force in forces},
            float(content.arrays["depth"]),
            {},
            content.provenance,
        )
    except (ValueError, TypeError, IndexError) as fault:
        raise ModelFileError(f"{path}: {fault}") from None


def _robot(arrays: Mapping[str, np.ndarray], where: str) -> RobotModel:
    part = {name: arrays[f"{where}/{name}"] for name in (*ROBOT, "fresh")}
    rate = float(arrays[f"{where}/rate"])
    axes = tuple(
        AxisModel(b, a, int(delay), rate)
        for b, a, delay in zip(part["numerator"], part["denominator"], part["delay"], strict=True)
    )
    return RobotModel(axes, part["frequency"], part["response"], part["spread"], part["fresh"])


def _process(arrays: Mapping[str, np.ndarray], force: str) -> Process:
    models = []
    for letter in ("G_M", "G_K"):
        parts: dict[str, Any] = {name: arrays[f"{letter}/{force}/{name}"] for name in MATRICES}
        models.append(InnovationModel(**parts, rate=float(arrays[f"{letter}/{force}/rate"])))
    fresh = [arrays[f"{letter}/{force}/fresh"] for letter in ("G_M", "G_K")]
    other = [arrays[f"coupling/{force}/{name}"] for name in ("frequency", "response")]
    return Process(ProcessModel(*models), *fresh, *other)
