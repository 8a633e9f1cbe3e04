"""The preloaded stepped sine: which tones are played, in which batches, in both passes."""

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from calibration.experiment import Batch, Plan
from calibration.preload import preload_frequencies
from calibration.refinement import memory, refined
from calibration.stepped_sine import Tones
from calibration.sweep_estimate import decimation
from vibractl.config import RigConfig
from vibractl.shot_file import hydrophone_names
from vibractl.transfer_matrix import TransferMatrix

BATCH = 30.0
"""s, a batch at most, unless one tone takes longer."""
SILENCE = 10.0
"""s, recorded before all tones: what is heard then is heard beside every tone."""
TOLERANCE = 0.004
"""1, error of interpolation, relative to the response, to which the second pass refines the grid."""
SETTLED = 4.0
"""Time constants of the response, as the first pass saw it, that the second pass lets pass before a tone ..."""
LONGEST_SETTLE = 1.0
"""s, ... at most."""
CHOSEN_SETTLE = 0.3
"""s, before a tone that was chosen because the response is narrow there."""
FEWEST = 4
"""Lines of a model."""


@dataclass(frozen=True)
class Silence:
    """A batch without a drive.

    Parameters
    ----------
    samples, sides : int
    """

    samples: int
    sides: int

    def drive(self) -> np.ndarray:
        """Return zeros, shape (samples, sides), V."""
        return np.zeros((self.samples, self.sides))


def first_pass(config: RigConfig) -> Plan:
    """Plan silence and an evenly spaced sweep, up on the first side and down on the next."""
    settings = config.characterisation
    low, high = settings.band
    frequency = low + settings.step * np.arange(int(np.floor((high - low) / settings.step + 1e-9)) + 1)
    silence = Silence(round(SILENCE * config.audio.rate), len(config.audio.drive_channels))
    batches = [silence, *_batches(config, frequency, np.full(len(frequency), settings.settle))]
    return _plan(config, "pass-1", batches)


def second_pass(config: RigConfig, first: TransferMatrix) -> Plan:
    """Plan the sweep again, with more lines where the response bends and more patience where it rings.

    Source
    ------
    Sörnmo 2015, sec. 6.6: the grid is refined around peaks and notches, and everything measured once more.

    Departs
    -------
    The time to settle grows with the response's own time constant: in half a second a mode of 1 Hz bandwidth does not
    forget the tone before.
    """
    settings = config.characterisation
    frequency = refined(first.frequency, first.response, TOLERANCE, settings.finest)
    ringing = np.interp(frequency, first.frequency, memory(first.frequency, first.response))
    settle = np.clip(SETTLED * ringing, settings.settle, max(LONGEST_SETTLE, settings.settle))
    settle = np.ceil(settle * 100) / 100
    return _plan(config, "pass-2", _batches(config, frequency, settle))


def chosen_tones(config: RigConfig, frequency: np.ndarray) -> Plan:
    """Plan a short sweep over the lines given, shape (tones,), Hz, rising, with the patience of narrow ones."""
    settle = np.full(len(frequency), max(config.characterisation.settle, CHOSEN_SETTLE))
    return _plan(config, "tones", _batches(config, frequency, settle))


def refuse_unfit_sweep(config: RigConfig) -> None:
    """Refuse a sweep that could not end in a model: levels above the guard's limits, or too few lines.

    Raises
    ------
    ValueError : it says which setting, and what is allowed.
    """
    settings, limits = config.characterisation, config.limits
    widest = (settings.band[1] - settings.band[0]) / (FEWEST - 1)
    if not settings.step <= widest:
        raise ValueError(
            f"characterisation.step is {settings.step:g} Hz, must be <= {widest:g} Hz for {FEWEST} bins in the band"
        )
    peak, rms = settings.preload + settings.probe, np.hypot(settings.preload, settings.probe) / np.sqrt(2)
    for what, value, name, limit in (("", peak, "peak", limits.peak), (", rms,", rms, "rms", limits.rms)):
        if not value <= limit:
            raise ValueError(
                f"characterisation.preload + characterisation.probe{what} is {value:.4g} V, "
                f"must be <= limits.{name}, {limit:g} V"
            )


def longest_sweep(config: RigConfig) -> float:
    """Return how long all passes of a stepped sine are, as a rule, s: each as the first with the longest patience."""
    settings, sides = config.characterisation, len(config.audio.drive_channels)
    tones = (settings.band[1] - settings.band[0]) / settings.step + 1
    patience = max(settings.settle, LONGEST_SETTLE) if settings.passes > 1 else settings.settle
    return float(settings.passes * tones * sides * (settings.tone + patience) + SILENCE)


def longest_batch(config: RigConfig) -> float:
    """Return how long a batch of this rig can be, s."""
    settings, sides = config.characterisation, len(config.audio.drive_channels)
    one = sides * (settings.tone + max(settings.settle, LONGEST_SETTLE))
    return 2 * max(BATCH, one) + SILENCE


def _batches(config: RigConfig, frequency: np.ndarray, settle: np.ndarray) -> list[Batch]:
    settings, sides = config.characterisation, len(config.audio.drive_channels)
    preload = preload_frequencies(frequency, settings.preload_band)
    elapsed = np.cumsum(sides * (settle + settings.tone))
    number = np.floor(elapsed / BATCH).astype(int)
    parts = [np.flatnonzero(number == each) for each in np.unique(number)]
    step = decimation(config)
    return [
        Tones(
            frequency[part], preload[part], settle[part], settings.tone, settings.preload, settings.probe,
            sides, float(config.audio.rate), step,
        )
        for part in parts
    ]  # fmt: skip


def _plan(config: RigConfig, name: str, batches: list[Batch]) -> Plan:
    """Put a plan together; its settings are all that drives and plant depend on."""
    drives, responses, rig = depends_on_rig(config)
    depends = {
        **rig,
        **{
            f"characterisation.{key}": repr(getattr(config.characterisation, key))
            for key in ("band", "step", "tone", "settle", "preload", "preload_band", "probe")
        },
        "tones": _digest(batches),
    }
    return Plan(name, depends, float(config.audio.rate), drives, responses, batches)


def depends_on_rig(config: RigConfig) -> tuple[list[tuple[str, str]], list[tuple[str, str]], dict[str, str]]:
    """Return names and units of drives and of all that is heard, and what of the rig a recording depends on."""
    audio = config.audio
    depends = {
        "rig.name": config.rig.name,
        **{f"audio.{key}": repr(getattr(audio, key)) for key in ("stream", "device", "rate", "drive_channels")},
        **{f"audio.{key}": repr(getattr(audio, key)) for key in ("response_channels", "input_full_scale")},
        **{f"simulator.options.{key}": repr(value) for key, value in sorted(config.simulator.options.items())},
        "simulator.plant": config.simulator.plant,
    }
    if audio.far_field_channels:
        depends |= {f"audio.{key}": repr(getattr(audio, key)) for key in ("far_field_channels", "far_field_full_scale")}
    drives = [(f"drive_{side + 1}", "V") for side in range(len(audio.drive_channels))]
    responses = [(f"response_{side + 1}", "m/s^2") for side in range(len(audio.response_channels))]
    hydrophones = [(name, "Pa") for name in hydrophone_names(config)]
    return drives, [*responses, *hydrophones], depends


def _digest(batches: Iterable[Batch]) -> str:
    """Tell one list of tones from another, whichever settings or version of this program made it."""
    tones = hashlib.sha256()
    for batch in batches:
        if isinstance(batch, Tones):
            for part in (batch.frequency, batch.preload_frequency, batch.settle, batch.starts.astype(float)):
                tones.update(np.round(part, 6).tobytes())
    return tones.hexdigest()[:16]
