"""A calibration by multisines: records them, quiet ones in two steps, and turns them into a model and its levels."""

import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from calibration.emission_limit import EmissionLimit
from calibration.experiment import Emit, Plan, RawFolder
from calibration.far_field_estimate import far_field_of
from calibration.multisine import Design, Record
from calibration.multisine_estimate import (
    Levels,
    Spectra,
    coherence_of,
    frequency_of,
    levels,
    matrix_on,
    raw_matrix,
    spectra_of,
)
from calibration.quiet_multisine import doubted, scout_design, shaped_design
from calibration.quiet_probes import Probes
from calibration.vibrator_multisine import (
    SEED,
    design_of,
    emitted_seconds,
    flat_design,
    multisine_plan,
    refuse_too_loud,
)
from calibration.working_drive import reference_drive
from rigkit.progress import progress
from vibractl.audio import Clipped
from vibractl.config import RigConfig
from vibractl.far_field import FarField
from vibractl.transfer_matrix import TransferMatrix

QUIETER, WEAKER = 0.5, 3
"""By how much the records are weaker, and how often they may be, where a sensor clips."""


@dataclass(frozen=True)
class Multisined:
    """What multisines found.

    Parameters
    ----------
    matrix : TransferMatrix
    levels : Levels
    emitted : float, s
        Of signal, over all records.
    loudest : float or None, dB
        Strongest line of the multisine from `quality.above` on, re what the preload emits.
    far : FarField or None
        Where there are hydrophones.
    over : float or None, dB
        Of the loudest line of all recordings over the limit that the reference sets, see `EmissionLimit`.
    """

    matrix: TransferMatrix
    levels: Levels
    emitted: float
    loudest: float | None
    far: FarField | None
    over: float | None = None


def measure_by_multisine(config: RigConfig, raw: RawFolder, emit: Emit, provenance: Mapping[str, str]) -> Multisined:
    """Measure the transfer matrix by multisines on top of the preload.

    Parameters
    ----------
    config : RigConfig
    raw : RawFolder
        Open; what it holds already is not measured again.
    emit : Emit
    provenance : mapping of strings
        The recording is added to it.

    Source
    ------
    Pintelon and Schoukens 2012, System Identification, sec. 4.3 and 7.
    """
    emitted, over, within = 0.0, -np.inf, None
    limit = EmissionLimit.of(config) if config.characterisation.quiet else _limit_of_a_reference(config)
    if config.characterisation.quiet and limit is not None:
        within = limit
        designed, emitted, over = _scouted(config, within, raw, emit)
        played = _played("multisine", designed, config, raw, emit, within)
    elif config.characterisation.around == "reference":
        designed, emitted, over = _at_work(config, limit, raw, emit)
        played = _played("around-reference", designed, config, raw, emit)
    else:
        played = _unclipped(config, raw, emit)
    plan, (design, detection), spectra = played.plan, played.design, played.felt
    about = {**provenance, "recording": f"{raw.path.name}/{plan.name}-*.wav, fingerprint {plan.fingerprint}"}
    matrix = _model(config, design, spectra, about)
    loudest = None if within is not None else _loudest(config, design, spectra)
    far = _far_field(config, design, spectra, played.heard, matrix.frequency)
    found = Multisined(matrix, levels(design, spectra, detection), emitted + emitted_seconds(plan), loudest, far)
    return found if limit is None else replace(found, over=max(over, _over(limit, design, spectra)))


Designed = tuple[Design, np.ndarray]
"""A design, and the odd bins that it does not excite."""


@dataclass(frozen=True)
class _Played:
    """A plan that was played, what it was made from, and what accelerometers and hydrophones have heard."""

    plan: Plan
    design: Designed
    felt: Spectra
    heard: Spectra


def _played(
    name: str, design: Designed, config: RigConfig, raw: RawFolder, emit: Emit, limit: EmissionLimit | None = None
) -> _Played:
    plan = multisine_plan(config, name, design[0], limit=limit)
    return _Played(plan, design, *_recorded(plan, design[0], config, raw, emit))


def _unclipped(config: RigConfig, raw: RawFolder, emit: Emit) -> _Played:
    """Play records around the band's preload; weaker ones, preload and all, where a sensor clips."""
    asked = dict(_quieter(config))
    *louder, weakest = raw.left(list(asked))
    for name in louder:
        try:
            return _played(name, flat_design(asked[name]), asked[name], raw, emit)
        except Clipped as fault:
            sys.stderr.write(f"{name}: {fault}; again, {-20 * np.log10(QUIETER):.0f} dB weaker\n")
    try:
        return _played(weakest, flat_design(asked[weakest]), asked[weakest], raw, emit)
    except Clipped as fault:
        if len(asked) < 2:
            raise
        weaker = -20 * np.log10(QUIETER) * (len(asked) - 1)
        raise Clipped(
            f"{fault}; {weaker:.0f} dB weaker is too loud still: is audio.input_full_scale "
            f"{config.audio.input_full_scale} m/s^2 and the card's gain what the sensors have? Else lower "
            f"characterisation.operating, {config.characterisation.operating:g}, and probe"
        ) from None


def _quieter(config: RigConfig) -> Iterator[tuple[str, RigConfig]]:
    """Give what is played, by name: first as it is asked for."""
    for number in range(WEAKER + 1):
        part = QUIETER**number
        asked = config.characterisation
        weaker = {"operating": part * asked.operating, "probe": part * asked.probe}
        name = "multisine" if number == 0 else f"multisine-{number + 1}"
        yield name, config.model_copy(update={"characterisation": asked.model_copy(update=weaker)})


def _limit_of_a_reference(config: RigConfig) -> EmissionLimit | None:
    """Return the limit that the reference sets; None where there is none that can be made."""
    try:
        return EmissionLimit.of(config)
    except (ValueError, OSError):
        return None


def _scouted(config: RigConfig, limit: EmissionLimit, raw: RawFolder, emit: Emit) -> tuple[Designed, float, float]:
    """Find how loud every line may be: return what is to be played, s emitted, and the loudest line, dB."""
    probes, emitted, over, number = Probes(scout_design(config), limit), 0.0, -np.inf, 0
    while not probes.done:
        one, number = probes.design, number + 1
        plan = multisine_plan(config, f"probe-{number}", one, rest=0.0, limit=limit)
        spectra, _ = _recorded(plan, one, config, raw, emit)
        emitted, over = emitted + emitted_seconds(plan), max(over, _over(limit, one, spectra))
        probes.take(spectra)
    scout = probes.scout
    plan = multisine_plan(config, "scout", scout, rest=0.0, limit=limit)
    spectra, _ = _recorded(plan, scout, config, raw, emit)
    emitted, over = emitted + emitted_seconds(plan), max(over, _over(limit, scout, spectra))
    wanted = np.arange(scout.bins[0], scout.bins[-1] + 1)
    response, _ = matrix_on(scout, raw_matrix(scout, spectra), wanted)
    return shaped_design(config, wanted * scout.rate / scout.period, response, limit), emitted, over


def _at_work(
    config: RigConfig, limit: EmissionLimit | None, raw: RawFolder, emit: Emit
) -> tuple[Designed, float, float]:
    """Measure around a band's preload what the reference needs, and put it in its place; returns as `_scouted`."""
    first = _unclipped(config, raw, emit)
    working = reference_drive(config, _model(config, first.design[0], first.felt, {}), np.random.default_rng(SEED))
    settings = config.characterisation
    designed = design_of(config, settings.records, settings.level, working)
    asked = f"characterisation.around = reference, at reference.amplitude {config.reference.amplitude:g} m/s^2,"
    refuse_too_loud(config, designed[0], asked)
    over = -np.inf if limit is None else _over(limit, first.design[0], first.felt)
    return designed, emitted_seconds(first.plan), over


def _over(limit: EmissionLimit, design: Design, spectra: Spectra) -> float:
    """Return by how much the loudest line of any record, excited or not, is over the limit, dB."""
    return limit.over(frequency_of(design, spectra), spectra.response, spectra.silence)


def preload_density(spectra: Spectra, design: Design) -> np.ndarray:
    """Return the amplitude of a line, (outputs,), m/s^2, were what the preload emits spread over its whole band."""
    low, high = (edge - spectra.first for edge in design.working)
    preload = spectra.response[:, low : high + 1].mean(axis=0)
    density: np.ndarray = np.sqrt(np.mean(np.abs(preload) ** 2, axis=0))
    return density


def _model(config: RigConfig, design: Design, spectra: Spectra, about: Mapping[str, str]) -> TransferMatrix:
    low, high = (edge * design.period / design.rate for edge in config.characterisation.band)
    wanted = np.arange(int(np.floor(low + 1e-9)), int(np.ceil(high - 1e-9)) + 1)
    response, variance = matrix_on(design, raw_matrix(design, spectra), wanted)
    frequency = wanted * design.rate / design.period
    coherence = coherence_of(response, variance)
    if config.characterisation.quiet:
        variance = doubted(frequency, response, variance)
    return TransferMatrix(frequency, response, variance, coherence, about)


def _far_field(
    config: RigConfig, design: Design, spectra: Spectra, heard: Spectra, wanted: np.ndarray
) -> FarField | None:
    if not config.audio.far_field_channels:
        return None
    lines, run_in = design.frequency, config.characterisation.run_in
    response, pressure = raw_matrix(design, spectra), raw_matrix(design, heard)
    return far_field_of(config, lines, response, pressure, wanted, ("characterisation.run_in", run_in))


def _loudest(config: RigConfig, design: Design, spectra: Spectra) -> float | None:
    """Return the strongest line above 100 Hz that the multisine adds to any record, dB re what the preload emits."""
    place = design.bins[design.frequency >= config.quality.above] - spectra.first
    if not len(place):
        return None
    added = np.abs(spectra.response - spectra.response.mean(axis=0))[:, place].max(axis=(0, 1))
    return float(20 * np.log10(np.max(added / preload_density(spectra, design))))


def _periods(plan: Plan, design: Design, raw: RawFolder, emit: Emit) -> Iterator[np.ndarray]:
    """Record a plan; yield the end of its silence, then the period of each record, all (period, channels)."""
    done = 0.0
    title = f"{plan.name}, {plan.seconds:.0f} s to record"
    with progress(title, plan.seconds, start=raw.recorded(plan)) as meter:
        for batch, record in raw.record(plan, emit):
            yield record.data[batch.window if isinstance(batch, Record) else slice(-design.period, None)].astype(float)
            done += batch.samples / plan.rate
            meter.show(done)


def _recorded(plan: Plan, design: Design, config: RigConfig, raw: RawFolder, emit: Emit) -> tuple[Spectra, Spectra]:
    """Record a plan and transform the periods: as accelerometers and as hydrophones have heard them."""
    sides = len(config.audio.drive_channels)
    low, high = design.working
    bins = min(int(design.bins[0]), low), max(int(design.bins[-1]), high)
    periods = _periods(plan, design, raw, emit)
    found = spectra_of(design, ((each[:, :sides], each[:, sides:]) for each in periods), *bins)
    near = len(config.audio.response_channels)
    parts = (slice(None, near), slice(near, None))
    felt, heard = (replace(found, response=found.response[..., p], silence=found.silence[:, p]) for p in parts)
    return felt, heard
