"""The multisine's plans: which records are played, and how loud."""

import hashlib

import numpy as np

from calibration.emission_limit import EmissionLimit
from calibration.experiment import Batch, Plan
from calibration.multisine import FADE, Design, Record, codes, odd_lines
from calibration.multisine_estimate import REACH
from calibration.quiet_probes import MOST_LOW, MOST_STUCK
from calibration.vibrator_sweep import Silence, depends_on_rig
from calibration.working_drive import WorkingDrive, band_drive
from vibractl.config import RigConfig

SEED = 1
"""Of the phases: every calibration plays the same ones."""
GROUP = 5
"""Odd lines, of which one is left out for distortion to show."""
REST = 2.0
"""s of the silence before its measured part, for what was played before to ring down."""
QUIET_SPARE = 3
"""Records by which `characterisation.records` must be more than the coils, for a quiet calibration takes fewer."""
PROBES = MOST_LOW + MOST_STUCK
"""Of a quiet calibration at most."""
KEYS = ("band", "preload_band", "records", "period", "run_in", "operating", "level", "quiet")


def flat_design(config: RigConfig) -> tuple[Design, np.ndarray]:
    """Design records whose lines are all equally strong.

    Returns
    -------
    design : Design
    detection : int array
        Odd bins that are not excited.
    """
    return design_of(config, config.characterisation.records, config.characterisation.level)


def multisine_plan(
    config: RigConfig, name: str, design: Design, rest: float = REST, limit: EmissionLimit | None = None
) -> Plan:
    """Plan `rest` seconds and a period of silence, which is the part that counts, and all records of a design.

    What a design within a limit is made from is recorded before it.
    """
    sides, settings = len(config.audio.drive_channels), config.characterisation
    silence = Silence(round(rest * design.rate) + design.period, sides)
    batches: list[Batch] = [silence, *(Record(design, number) for number in range(design.records))]
    settled = {f"characterisation.{key}": repr(getattr(settings, key)) for key in KEYS}
    digest = hashlib.sha256()
    for part in (design.bins, design.code, np.round(design.phase, 9), design.preload):
        digest.update(np.ascontiguousarray(part, dtype=float).round(9).tobytes())
    drives, responses, rig = depends_on_rig(config)
    depends = {**rig, **settled, "objective": repr(config.quality.objective), "lines": digest.hexdigest()[:16]}
    if limit is not None:
        depends["emission limit"] = f"{limit.tone:.6g} m/s^2"
    return Plan(name, depends, float(config.audio.rate), drives, responses, batches)


def emitted_seconds(plan: Plan) -> float:
    """Return how long a plan of multisines emits, s: all but the silence."""
    return sum(batch.samples for batch in plan.batches if not isinstance(batch, Silence)) / plan.rate


def longest_multisines(config: RigConfig) -> float:
    """Return how long all records of multisines may be with the silence before each kind, s."""
    settings = config.characterisation
    kinds = 2 if settings.around == "reference" else 1
    records = kinds * settings.records + settings.quiet * (len(config.audio.drive_channels) + QUIET_SPARE + PROBES)
    kinds += (1 + PROBES) * settings.quiet
    return float(kinds * (REST + settings.period) + records * (settings.run_in + settings.period + FADE))


def refuse_unfit_multisine(config: RigConfig) -> None:
    """Refuse a multisine that could not end in a model: too loud for the guard, too few lines or records.

    Raises
    ------
    ValueError : it says which setting, and what is allowed.
    """
    settings, sides = config.characterisation, len(config.audio.drive_channels)
    fewest = sides + QUIET_SPARE * settings.quiet
    if not settings.records > fewest:
        raise ValueError(
            f"characterisation.records is {settings.records}, must be > {fewest} for {sides} coils"
            f"{' and quiet records' * settings.quiet}"
        )
    if not settings.run_in >= FADE:
        raise ValueError(f"characterisation.run_in is {settings.run_in:g} s, must be >= {FADE:g} s")
    if not settings.band[0] * settings.period >= 1:
        raise ValueError(
            f"characterisation.band begins at {settings.band[0]:g} Hz, must be >= {1 / settings.period:g} Hz, "
            "one cycle of characterisation.period"
        )
    lines, least = _bins(config)[1] - _bins(config)[0], 2 * GROUP * (2 * REACH + 1) / (GROUP - 1)
    if not lines >= least:
        raise ValueError(
            f"characterisation.band is {settings.band[1] - settings.band[0]:g} Hz wide, must be >= "
            f"{(least - 4 * REACH) / settings.period:g} Hz for a polynomial over {2 * REACH + 1} bins"
        )
    if settings.quiet:
        return  # there is no preload, and what is played is far below any limit of a drive that can emit the reference
    refuse_too_loud(config, flat_design(config)[0], f"characterisation.operating of {settings.operating:g} V")


def refuse_too_loud(config: RigConfig, design: Design, cause: str) -> None:
    """Refuse records that the guard would stop; `cause` is what makes them so loud.

    Raises
    ------
    ValueError : it says by how much, and what is allowed.
    """
    drives = (Record(design, number).drive() for number in range(design.records))
    peak, rms = np.max([(np.abs(drive).max(), np.sqrt(np.mean(drive**2, axis=0)).max()) for drive in drives], axis=0)
    for what, value, limit in (("peak", peak, config.limits.peak), ("rms", rms, config.limits.rms)):
        if not value <= limit:
            raise ValueError(
                f"{cause} gives a multisine with {what} {value:.4g} V, must be <= limits.{what}, {limit:g} V"
            )


def design_of(
    config: RigConfig, records: int, level: float, working: WorkingDrive | None = None
) -> tuple[Design, np.ndarray]:
    """Design records whose lines are all equally strong.

    Parameters
    ----------
    config : RigConfig
    records : int
    level : float, dB
        Their density re the preload's, were that spread over `characterisation.preload_band`.
    working : WorkingDrive, optional
        The preload; without it the one over that band.

    Returns
    -------
    design : Design
    detection : int array
        Odd bins that are not excited.
    """
    settings, rate, sides = config.characterisation, float(config.audio.rate), len(config.audio.drive_channels)
    period, rng = round(settings.period * rate), np.random.default_rng(SEED)
    low, high = _bins(config)
    excited, detection = odd_lines(low, high, GROUP, rng)
    if working is None:
        working = band_drive(config, rng)
    operating = working.rms or settings.probe / np.sqrt(2)  # without a preload, re the stepped sine's probe
    density = operating * np.sqrt(2 / _lines_in(config, settings.preload_band))
    spread = np.sqrt((high - low + 1) / len(excited))  # the power of the lines that are left out is given to the others
    amplitude = np.full((len(excited), sides), density * spread * 10 ** (level / 20))
    phase = 2 * np.pi * rng.random((len(excited), sides))
    code = codes(len(excited), sides, records)
    run_in = round(settings.run_in * rate)
    bounds = int(working.bins[0]), int(working.bins[-1])
    return Design(period, rate, records, excited, amplitude, phase, code, working.signal, bounds, run_in), detection


def _lines_in(config: RigConfig, band: tuple[float, float]) -> float:
    return (band[1] - band[0]) * config.characterisation.period


def _bins(config: RigConfig) -> tuple[int, int]:
    """Return the first and last bin: the band, and so much beyond that its ends lie within a window."""
    settings, beyond = config.characterisation, 2 * REACH
    low, high = (edge * settings.period for edge in settings.band)
    top = int(0.4 * config.audio.rate * settings.period)
    return max(int(np.floor(low + 1e-9)) - beyond, 1), min(int(np.ceil(high - 1e-9)) + beyond, top)
