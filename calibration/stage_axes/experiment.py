"""What is recorded of an axis: a weak chirp that tells how loud to be, then two to learn from and one to judge by."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calibration.experiment import Plan, RawFolder
from calibration.stage_axes.bench import HEARD, ExcitationError, ExcitedAxis
from calibration.stage_axes.chirp import Chirp
from rigkit.agreement import GOING_ON
from rigkit.progress import progress
from stagectl.config import StageConfig

KIND = "stage calibration"
KEPT = GOING_ON.without("inner", "outer", "weights", "reference", "deflection", "laser")
"""What an unfinished one must have kept."""
DOWN, FRESH = 1.15, 1.25
"""Length of the falling chirp and of the fresh one, re the first."""
ONCE_MORE = 0.95
"""Share of the band that the other chirps begin or end at, so that none repeats another."""
HEADROOM = 0.98
"""Of limits, what a chirp may use."""
REST = 0.5
"""s before a chirp over which rest is averaged."""


@dataclass(frozen=True)
class Excited:
    """A chirp as recorded, less the rest before it.

    Parameters
    ----------
    drive : array, shape (N, 1), V or m
    extension, position : arrays, shape (N, axes), m
        Deviations from rest.
    """

    drive: np.ndarray
    extension: np.ndarray
    position: np.ndarray


@dataclass(frozen=True)
class Experiment:
    """The chirps of an axis with open, or with closed inner loop.

    Parameters
    ----------
    amplitude : float, V or m
    learned : tuple of Excited
        To identify from: a rising and a falling chirp.
    fresh : Excited
        To judge by.
    seconds : float, s
        Of signal.
    fingerprints : tuple of str
        Of the plans.
    """

    amplitude: float
    learned: tuple[Excited, ...]
    fresh: Excited
    seconds: float
    fingerprints: tuple[str, ...]


def record(bench: ExcitedAxis, raw: RawFolder) -> Experiment:
    """Excite an axis, or take what the folder has already.

    Parameters
    ----------
    bench : ExcitedAxis
    raw : RawFolder
        Open.

    Raises
    ------
    ExcitationError : the plate left its travel, or the guard shut the stage.
    """
    settings, rate = bench.config.characterisation, bench.config.stage.rate
    low, high = settings.band
    quiet = settings.scout if bench.loop is None else settings.scout * _gain(bench)
    scout = _plan(bench, "scout", [Chirp(rate, settings.settle, settings.seconds, low, high, quiet)])
    (weak,) = _recorded(bench, scout, raw)
    amplitude = _amplitude(bench, quiet, float(np.abs(weak.position[:, bench.axis]).max()))
    chirps = [
        Chirp(rate, settings.settle, settings.seconds, low, high, amplitude),
        Chirp(rate, settings.settle, DOWN * settings.seconds, ONCE_MORE * high, low / ONCE_MORE, amplitude),
        Chirp(rate, settings.settle, FRESH * settings.seconds, low * ONCE_MORE, high, ONCE_MORE * amplitude),
    ]
    plan = _plan(bench, "chirp", chirps)
    *learned, fresh = _recorded(bench, plan, raw)
    prints = scout.fingerprint, plan.fingerprint
    return Experiment(amplitude, tuple(learned), fresh, scout.seconds + plan.seconds, prints)


def require_room(config: StageConfig, axes: int, raw: RawFolder) -> None:
    """Refuse, by a `DiskFault`, a calibration of so many axes that the disk has no room for.

    Parameters
    ----------
    config : StageConfig
    axes : int
    raw : RawFolder
        What it has already needs no room.
    """
    settings, channels = config.characterisation, 1 + len(HEARD) * len(config.stage.axes)
    seconds = 4 * settings.settle + (2 + DOWN + FRESH) * settings.seconds  # scout, up, down, fresh
    raw.require_room(round(axes * 2 * seconds * config.stage.rate), channels)  # inner loop open, closed


def without_creep(position: np.ndarray, settled: float, rate: float) -> np.ndarray:
    """Take the creep of resting stacks off: what a constant and the logarithm of time explain.

    Parameters
    ----------
    position : array, shape (N, width), m
    settled : float, s
        Since the stacks came to rest, at the first sample.
    rate : float, samples/s

    Returns
    -------
    array, shape (N, width), m
    """
    law = np.log(settled + np.arange(len(position)) / rate)
    terms = np.stack([np.ones(len(law)), law - law.mean()], axis=1)
    found, *_ = np.linalg.lstsq(terms, position, rcond=None)
    left: np.ndarray = position - terms @ found
    return left


def _gain(bench: ExcitedAxis) -> float:
    gain = bench.config.inner.gain
    return gain[bench.axis % len(gain)]


def _amplitude(bench: ExcitedAxis, quiet: float, moved: float) -> float:
    """Return how loud the chirps may be: as far as the plate may move, within range and rate of the drive."""
    config, top = bench.config, 2 * np.pi * bench.config.characterisation.band[1]
    limits = config.limits
    low, high = limits.voltage if bench.loop is None else limits.extension
    slew = limits.voltage_slew if bench.loop is None else limits.extension_slew
    wanted = quiet * config.characterisation.excursion / moved
    most = HEADROOM * min(high - bench.centre, bench.centre - low, slew / top)
    return float(f"{min(wanted, most):.3g}")


def _plan(bench: ExcitedAxis, what: str, chirps: Sequence[Chirp]) -> Plan:
    config, axis = bench.config, bench.config.stage.axes[bench.axis]
    loop, unit, name = ("open", "V", "voltage") if bench.loop is None else ("closed", "m", "extension_reference")
    depends = {
        "rig.name": config.rig.name,
        "limits": repr(config.limits),
        **_which_stage(config),
        "inner": repr(bench.loop),
        **{f"chirp {number}": repr(chirp) for number, chirp in enumerate(chirps)},
    }
    heard = [(f"{signal}_{each}", "m") for signal in HEARD for each in config.stage.axes]
    return Plan(f"{axis}-{loop}-{what}", depends, config.stage.rate, [(f"{name}_{axis}", unit)], heard, chirps)


def _which_stage(config: StageConfig) -> dict[str, str]:
    if config.session.live:
        return {"stage": "behind the link"}
    options = {f"simulator.options.{key}": repr(value) for key, value in config.simulator.options.items()}
    return {"simulator.plant": config.simulator.plant, **options}


def _recorded(bench: ExcitedAxis, plan: Plan, raw: RawFolder) -> list[Excited]:
    axes, done = len(bench.config.stage.axes), 0.0
    low, high = bench.config.limits.travel
    parts = []
    with progress(f"{plan.name}, {plan.seconds:.0f} s of signal", plan.seconds, start=raw.recorded(plan)) as meter:
        for batch, kept in raw.record(plan, bench.emit):
            assert isinstance(batch, Chirp)
            data, before = kept.data.astype(float), slice(batch.rest - round(REST * plan.rate), batch.rest)
            place = data[:, 1 + axes + bench.axis]
            if not (place[batch.rest :].min() >= low and place[batch.rest :].max() <= high):
                raise ExcitationError(
                    f"{plan.name}: the plate went from {place.min():.3g} to {place.max():.3g} m, must stay within "
                    f"limits.travel, {low:g} to {high:g} m; lower characterisation.excursion"
                )
            moved = data[batch.rest :] - data[before].mean(axis=0)
            position = moved[:, 1 + axes :]
            others = np.arange(axes) != bench.axis
            position[:, others] = without_creep(position[:, others], batch.settle, plan.rate)
            parts.append(Excited(moved[:, :1], moved[:, 1 : 1 + axes], position))
            done += batch.samples / plan.rate
            meter.show(done)
    return parts
