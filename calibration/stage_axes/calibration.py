"""One axis from its first chirp to its loops: open, the PID that this makes, closed with it, and the loop around."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from calibration.experiment import RawFolder
from calibration.identification.workflow import Identification
from calibration.stage_axes.above import HeardResponse
from calibration.stage_axes.allowed import quiet_above
from calibration.stage_axes.bench import ExcitedAxis
from calibration.stage_axes.experiment import Experiment, record
from calibration.stage_axes.faster import at_rate, control_at_rate, stack_at_rate
from calibration.stage_axes.hearing import heard_above, heard_by_laser, heard_everywhere
from calibration.stage_axes.identification import Wanted, identified, simo, siso, stretched
from calibration.state_space.model import InnovationModel
from calibration.subspace.realization import Method
from stagectl.config import Inner, Outer, StageConfig
from stagectl.stage.allowed_gains import AllowedGains, of_axis
from stagectl.stage.design import Design, NoLoop
from stagectl.stage.design_refinement import designed
from stagectl.stage.measured_response import SMALL, MeasuredResponse
from stagectl.stage.piezo_pid import Pid, gain_at_rest, pid, robust_pid
from stagectl.stage.sensitivity import Robustness, robustness
from stagectl.stage.state_space import plant_of

FASTEST = 0.1
"""Of the highest frequency that is excited: the bandwidth up to which a PID is designed on such a model."""


@dataclass(frozen=True, eq=False)
class Opened:
    """An axis with open inner loop, and the PID that this makes.

    Parameters
    ----------
    experiment : Experiment
    stack : Identification
        From voltage to extension.
    one, every : Identification
        From voltage to the axis' position, and to those of all axes.
    loop : Pid
    inner : Inner
        What a rig file says to get this PID on this axis.
    robustness : Robustness
        Of the PID on the stack, with one sample of delay more.
    """

    experiment: Experiment
    stack: Identification
    one: Identification
    every: Identification
    loop: Pid
    inner: Inner
    robustness: Robustness


@dataclass(frozen=True, eq=False)
class Closed:
    """An axis with closed inner loop.

    Parameters
    ----------
    experiment : Experiment
    one, every : Identification
        From the inner loop's reference to the axis' position, and to those of all axes.
    above : HeardResponse, m/m
        To the axis' position above the frequencies that the models are made of.
    seen : HeardResponse or None, m/m
        To what a deflection's compensation takes for the robot's motion; None without a laser.
    measured : MeasuredResponse
        Both, and within the models' frequencies as well.
    """

    experiment: Experiment
    one: Identification
    every: Identification
    above: HeardResponse
    seen: HeardResponse | None
    measured: MeasuredResponse


@dataclass(frozen=True, eq=False)
class AxisCalibration:
    """What was found of an axis, in both ways.

    Parameters
    ----------
    axis : str
    top : float, Hz
        Highest frequency that was excited.
    opened : Opened
    closed : Closed
    outer : Design or str
        The outer loop on the closed loop's model; or why there is none.
    allowed : float, 1
        `Outer.allowed`: the controller's gain that is allowed at every frequency above `Outer.reach`.
    """

    axis: str
    top: float
    opened: Opened
    closed: Closed
    outer: Design | str
    allowed: float


def calibrate_axes(
    config: StageConfig,
    axes: Sequence[int],
    raw: RawFolder,
    order: int | None,
    method: Method,
    bench: Callable[[int, Pid | None], ExcitedAxis],
    about: Mapping[str, str],
) -> list[AxisCalibration]:
    """Identify axes, each with open inner loop and with the loop closed by the PID that this gives; choose outer loops.

    Parameters
    ----------
    config : StageConfig
    axes : sequence of int, counted from 0
    raw : RawFolder
        Open; what it holds already is not measured again.
    order : int or None
        Of the models of one output; None: as proposed.
    method : "n4sid" or "moesp"
    bench : callable(int, Pid or None) -> ExcitedAxis
        Gives an axis, counted from 0, to be excited: its voltage, or the reference of its inner loop.
    about : mapping of str to str
        The models' words.

    Source
    ------
    Sörnmo 2015, section 2.3: models by subspace identification, again with the inner loop closed.
    """
    found = []
    for axis in axes:
        opened = _opened(bench(axis, None), raw, order, method, about)
        closed = _closed(bench(axis, opened.loop), raw, order, method, about)
        allowed = quiet_above(config.outer, axis, closed.one.model, closed.above, closed.seen)
        outer = outer_loop(config.outer, axis, closed.one.model, allowed, closed.measured)
        name, top = config.stage.axes[axis], config.characterisation.band[1]
        everywhere = float(allowed.feedback.min(initial=of_axis(config.outer.beyond, axis)))
        found.append(AxisCalibration(name, top, opened, closed, outer, float(f"{everywhere:.3g}")))
    return found


def outer_loop(
    outer: Outer,
    axis: int,
    model: InnovationModel,
    allowed: AllowedGains | None = None,
    measured: MeasuredResponse | None = None,
) -> Design | str:
    """Choose the outer loop for a model, within the bounds of `[outer]`; return it, or why there is none.

    Parameters
    ----------
    outer : Outer
    axis : int, counted from 0
    model : InnovationModel
        From the inner loop's reference (m) to the position (m).
    allowed : AllowedGains, optional
        Above `outer.reach`, in place of those of `outer`.
    measured : MeasuredResponse, optional
        What the loop is held against as well.
    """
    try:
        return designed(model, outer, axis, allowed, measured)
    except NoLoop as fault:
        return str(fault)


def _opened(bench: ExcitedAxis, raw: RawFolder, order: int | None, method: Method, words: Mapping[str, str]) -> Opened:
    config, axis = bench.config, bench.axis
    name, settings = config.stage.axes[axis], config.characterisation
    experiment = record(bench, raw)
    about = {**words, **_recorded(raw, experiment)}
    drive = (f"voltage_{name}", "V")
    stack, one, every = (
        identified(experiment, wanted, config.stage.rate, settings.band[1], about)
        for wanted in (_stack(name, axis, method), *_positions(config, axis, drive, order, method))
    )
    above = heard_above(config, experiment, experiment.above.extension[:, axis])
    strongest = float(np.max(above.gain / above.frequency))  # as behind an integrator
    return Opened(experiment, stack, one, every, *inner_loop(config, axis, stack.model, strongest))


def inner_loop(
    config: StageConfig, axis: int, stack: InnovationModel, above: float = 0.0
) -> tuple[Pid, Inner, Robustness]:
    """Return the PID to close the loop with, what a rig file says to get it, and how robust it is on the stack.

    Parameters
    ----------
    config : StageConfig
    axis : int, counted from 0
    stack : InnovationModel
        From voltage (V) to extension (m).
    above : float, m/V per Hz, optional
        Largest gain over frequency, above the frequencies that the model is made of: integral action is so slow that
        the loop's gain is small there.
    """
    settings = config.characterisation
    if settings.inner == "rig":
        given = pid(config.inner, axis)
        figures = robustness(plant_of(stack), given.system(stack.rate), stack.rate, delay=1)
        return given, slow(config.inner, axis, np.inf), figures
    most = SMALL * gain_at_rest(stack) / above if above > 0 else np.inf
    wished = slow(config.inner, axis, min(FASTEST * settings.band[1], most))
    loop, figures = robust_pid(stack, wished, 0, settings.max_sensitivity)
    gain = gain_at_rest(stack)
    made = {"gain": (gain,), "bandwidth": (loop.integral * gain / (2 * np.pi),)}
    return loop, wished.model_copy(update=made), figures


def _closed(bench: ExcitedAxis, raw: RawFolder, order: int | None, method: Method, words: Mapping[str, str]) -> Closed:
    config, axis = bench.config, bench.axis
    experiment = record(bench, raw)
    about = {**words, **_recorded(raw, experiment), "inner": repr(bench.loop)}
    drive = (f"extension_reference_{config.stage.axes[axis]}", "m")
    own, others = _positions(config, axis, drive, order, method)
    one, every = (
        identified(experiment, wanted, config.stage.rate, config.characterisation.band[1], about)
        for wanted in (replace(own, convert=control_at_rate), others)
    )
    above = heard_above(config, experiment, experiment.above.position[:, axis])
    seen = heard_by_laser(config, axis, experiment)
    return Closed(experiment, one, every, above, seen, heard_everywhere(config, axis, experiment, above, seen))


def _positions(
    config: StageConfig, axis: int, drive: tuple[str, str], order: int | None, method: Method
) -> tuple[Wanted, Wanted]:
    """Return what is wanted of the axis' own position, and of all."""
    names = tuple(f"position_{each}" for each in config.stage.axes)
    return (
        Wanted(siso(axis), drive, names[axis : axis + 1], order, method, at_rate),
        Wanted(simo(), drive, names, None, method, at_rate),
    )


def _stack(name: str, axis: int, method: Method) -> Wanted:
    return Wanted(stretched(axis), (f"voltage_{name}", "V"), (f"extension_{name}",), None, method, stack_at_rate)


def slow(inner: Inner, axis: int, most: float) -> Inner:
    """Return the settings of one axis, of no more bandwidth than `most`, Hz: the model knows nothing beyond."""
    bandwidth = min(inner.bandwidth[axis % len(inner.bandwidth)], most)
    gain = inner.gain[axis % len(inner.gain)]
    return inner.model_copy(update={"bandwidth": (bandwidth,), "gain": (gain,)})


def _recorded(raw: RawFolder, experiment: Experiment) -> dict[str, str]:
    return {"recording": f"{raw.path.name}/, fingerprints {', '.join(experiment.fingerprints)}"}
