"""What is recorded of an axis: weak chirps that tell how loud to be, then two to learn from and one to judge by."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from calibration.experiment import Plan, RawFolder
from calibration.stage_axes.bench import HEARD, ExcitationError, ExcitedAxis, centre_of
from calibration.stage_axes.chirp import Chirp
from calibration.stage_axes.level import APPROACH, HEADROOM, Step, strongest
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
USED = 0.98
"""Of the drive's limits, what a chirp may use."""
WEAKER = 1.0, 0.6, 0.36, 0.2, 0.1
FAINTER = 1.0, 0.3, 0.1
"""Of the amplitude that was foreseen, what is played in turn where plate or stack go too far: of the loud chirps; of
scout and approach."""
BEGUN = 0.85
"""Of its own band, where that chirp begins, faint at first."""
NYQUIST = 0.4
"""Of the rate, up to which a chirp goes."""
HIGHER, SHORTER = 4.0, 0.5
"""How far above the band one more chirp goes, re its end, and its length, re the first."""
REST = 0.5
"""s before a chirp over which rest is averaged."""


@dataclass(frozen=True)
class Excited:
    """A chirp as recorded, less the rest before it.

    Parameters
    ----------
    drive : array, shape (N, 1), V or m
    extension, position, absolute : arrays, shape (N, axes), m
        Deviations from rest; the last is what a laser sees, 0 where there is none.
    rest : array, shape (2, axes), m
        Extensions, and positions, before it.
    """

    drive: np.ndarray
    extension: np.ndarray
    position: np.ndarray
    absolute: np.ndarray
    rest: np.ndarray


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
    above : Excited
        From the band's end on, to see what the models know nothing of.
    """

    amplitude: float
    learned: tuple[Excited, ...]
    fresh: Excited
    seconds: float
    fingerprints: tuple[str, ...]
    above: Excited


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
    settings = bench.config.characterisation
    quiet = settings.scout if bench.loop is None else settings.scout * _gain(bench)
    plans = [_scout(bench, f"scout{_numbered(number)}", part * quiet) for number, part in enumerate(FAINTER)]
    scout, (weak,) = _first_within_limits(bench, raw, plans)
    quiet = _loudest(scout)
    steps, played = [_step(bench, quiet, weak)], [scout]
    amplitude = _amplitude(bench, steps, weak)
    if amplitude > APPROACH * quiet:
        parts = [part for part in FAINTER if part * amplitude > APPROACH * quiet] or FAINTER[:1]
        plans = [_scout(bench, f"approach{_numbered(n)}", part * amplitude / APPROACH) for n, part in enumerate(parts)]
        approach, (weak,) = _first_within_limits(bench, raw, plans)
        played.append(approach)
        steps.append(_step(bench, _loudest(approach), weak))
        amplitude = _amplitude(bench, steps, weak)
    plans = [_chirps(bench, number, part * amplitude) for number, part in enumerate(WEAKER)]
    plan, (*learned, fresh) = _first_within_limits(bench, raw, plans)
    amplitude = _loudest(plan)
    played.append(plan)
    higher = _higher(bench, amplitude)
    played.append(higher)
    (above,) = _recorded(bench, higher, raw)
    seconds = sum(each.seconds for each in played)
    return Experiment(amplitude, tuple(learned), fresh, seconds, tuple(each.fingerprint for each in played), above)


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
    seconds = 6 * settings.settle + (3 + DOWN + FRESH + SHORTER) * settings.seconds  # scout to fresh, and above
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


def _scout(bench: ExcitedAxis, what: str, amplitude: float) -> Plan:
    settings, rate = bench.config.characterisation, bench.config.stage.rate
    return _plan(bench, what, [Chirp(rate, settings.settle, settings.seconds, *settings.band, _rounded(amplitude))])


def _first_within_limits(bench: ExcitedAxis, raw: RawFolder, plans: Sequence[Plan]) -> tuple[Plan, list[Excited]]:
    """Record the first of ever weaker plans with which the plate stays within its travel.

    A plan that shuts a simulated stage's guard is too loud as well; a live stage stays shut until a person has looked.
    """
    named = {plan.name: plan for plan in plans}
    *louder, weakest = (named[name] for name in raw.left(list(named)))
    for plan in louder:
        with suppress(ExcitationError):
            return plan, _recorded(bench, plan, raw, "again, weaker")
    return weakest, _recorded(bench, weakest, raw)


def _numbered(number: int) -> str:
    """Return what is added to a name that comes once more: nothing at first, then 2."""
    return f"{number + 1}" if number else ""


def _loudest(plan: Plan) -> float:
    return max(batch.amplitude for batch in plan.batches if isinstance(batch, Chirp))


def _chirps(bench: ExcitedAxis, number: int, amplitude: float) -> Plan:
    settings, rate, amplitude = bench.config.characterisation, bench.config.stage.rate, _rounded(amplitude)
    low, high = settings.band
    chirps = [
        Chirp(rate, settings.settle, settings.seconds, low, high, amplitude),
        Chirp(rate, settings.settle, DOWN * settings.seconds, ONCE_MORE * high, low / ONCE_MORE, amplitude),
        Chirp(rate, settings.settle, FRESH * settings.seconds, low * ONCE_MORE, high, ONCE_MORE * amplitude),
    ]
    return _plan(bench, f"chirp{_numbered(number)}", chirps)


def _higher(bench: ExcitedAxis, amplitude: float) -> Plan:
    """Return a chirp from the band's end on, at the amplitude of the others or what the drive's rate allows."""
    settings, rate, limits = bench.config.characterisation, bench.config.stage.rate, bench.config.limits
    slew = limits.voltage_slew if bench.loop is None else limits.extension_slew
    low, high = BEGUN * settings.band[1], above_band(bench.config)[1]
    quiet = _rounded(min(amplitude, USED * slew / (2 * np.pi * high)))
    return _plan(bench, "above", [Chirp(rate, settings.settle, SHORTER * settings.seconds, low, high, quiet)])


def above_band(config: StageConfig) -> tuple[float, float]:
    """Return from where to where the chirp above the band goes, Hz."""
    top = config.characterisation.band[1]
    return top, min(HIGHER * top, NYQUIST * config.stage.rate)


def _step(bench: ExcitedAxis, amplitude: float, heard: Excited) -> Step:
    moved = [np.abs(signal[:, bench.axis]).max() for signal in (heard.position, heard.position, heard.extension)]
    return Step(amplitude, np.array(moved))


def _amplitude(bench: ExcitedAxis, steps: Sequence[Step], heard: Excited) -> float:
    """Return how loud the chirps may be: as far as plate and stack may move, within range and rate of the drive."""
    config, top = bench.config, 2 * np.pi * bench.config.characterisation.band[1]
    limits, (extension, position) = config.limits, heard.rest[:, bench.axis]
    room = np.array(
        [
            config.characterisation.excursion,
            HEADROOM * min(limits.travel[1] - position, position - limits.travel[0]),
            HEADROOM * min(config.sensors.extension[1] - extension, extension - config.sensors.extension[0]),
        ]
    )
    low, high = limits.voltage if bench.loop is None else limits.extension
    slew = limits.voltage_slew if bench.loop is None else limits.extension_slew
    centre = centre_of(config, bench.loop)
    most = USED * min(high - centre, centre - low, slew / top)
    return _rounded(min(strongest(steps, np.maximum(room, 0.0)), most))


def _rounded(amplitude: float) -> float:
    return float(f"{amplitude:.3g}")


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


def _recorded(bench: ExcitedAxis, plan: Plan, raw: RawFolder, otherwise: str = "") -> list[Excited]:
    """Record a plan, or read it; where it goes too far, raise an ExcitationError, and say what comes then."""
    done, parts = 0.0, []
    with progress(f"{plan.name}, {plan.seconds:.0f} s of signal", plan.seconds, start=raw.recorded(plan)) as meter:
        try:
            for batch, kept in raw.record(plan, bench.emit):
                assert isinstance(batch, Chirp)
                parts.append(_excited(bench, plan, batch, kept.data.astype(float)))
                done += batch.samples / plan.rate
                meter.show(done)
        except ExcitationError as fault:
            if otherwise:
                meter.say(f"{fault}; {otherwise}")
            raise
    return parts


def _excited(bench: ExcitedAxis, plan: Plan, batch: Chirp, data: np.ndarray) -> Excited:
    axes, (low, high) = len(bench.config.stage.axes), bench.config.limits.travel
    place = data[batch.rest :, 1 + axes + bench.axis]
    if not (place.min() >= low and place.max() <= high):
        raise ExcitationError(
            f"{plan.name}: the plate went from {place.min():.3g} to {place.max():.3g} m, must stay within "
            f"limits.travel, {low:g} to {high:g} m; lower characterisation.excursion"
        )
    rest = data[batch.rest - round(REST * plan.rate) : batch.rest].mean(axis=0)
    moved = data[batch.rest :] - rest
    position, absolute = moved[:, 1 + axes : 1 + 2 * axes], moved[:, 1 + 2 * axes :]
    others = np.arange(axes) != bench.axis
    position[:, others] = without_creep(position[:, others], batch.settle, plan.rate)
    places = rest[1 : 1 + 2 * axes].reshape(2, axes)
    return Excited(moved[:, :1], moved[:, 1 : 1 + axes], position, absolute, places)
