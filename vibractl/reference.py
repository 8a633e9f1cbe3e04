"""What the vibrator is to emit: a chirp, a sine, or a recording."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.signal.windows import tukey

from rigkit.foreign_record import is_of_integers, open_signals
from vibractl.reference_forms import FORMS, choices, written

LONGEST = 60.0
"""s, longest reference of one shot."""


@dataclass(frozen=True)
class Reference:
    """A reference for one shot.

    Parameters
    ----------
    text : str
        How it was asked for.
    signal : array, shape (frames, outputs), m/s^2
    root : float or None, Hz
        Frequency of a sine; None for anything else.
    taper : float, 1
        Part of it that is tapered at each end.
    rest : int, samples
        At its end, in which it is silent and the vibrator comes to rest.
    """

    text: str
    signal: np.ndarray
    root: float | None = None
    taper: float = 0.0
    rest: int = 0

    @property
    def sounded(self) -> np.ndarray:
        """The signal without its rest, (frames, outputs), m/s^2."""
        return self.signal[: len(self.signal) - self.rest]

    def with_rest(self, rest: int) -> "Reference":
        """Return it with so many samples of silence after it."""
        return replace(self, signal=np.pad(self.signal, ((0, rest), (0, 0))), rest=self.rest + rest)


def reference_from(
    text: str, rate: float, amplitude: float, taper: float, outputs: int, step: int, full_scale: float = 0.0
) -> Reference:
    """Make the reference that `text` asks for.

    Parameters
    ----------
    text : str
        One of `FORMS` with its numbers, or a WAV or CSV file of one channel (for all sides) or one per side.
    rate : float, samples/s
    amplitude : float, m/s^2, of a chirp or sine
    taper : float, 1, tapered part of a chirp or sine at each end
    outputs : int, accelerometers controlled
    step : int, samples
        The length is a multiple of it; a file is padded with silence, a chirp or sine must fit.
    full_scale : float, m/s^2
        Of a WAV file of integers, which must have one.

    Raises
    ------
    ValueError : not such a text, a number out of range, or an unusable file.

    Source
    ------
    Sörnmo 2015, sec. 6.6; eq. (6.14) for the sine.
    """
    kind, _, rest = text.partition(":")
    if is_file(text):
        return _from_file(Path(text), text, rate, outputs, step, full_scale)
    if kind not in FORMS:
        raise ValueError(f"reference {text!r} is not {choices('a .wav or .csv file')}")
    form, numbers = FORMS[kind], _numbers(text, kind, rest, rate)
    frames = round(numbers[-1] * rate)
    if frames % step:
        raise ValueError(f"reference {text}: {frames} samples, must be a multiple of {step} at {rate:g} samples/s")
    try:
        root = form.root(numbers)
    except ValueError as fault:
        raise ValueError(f"reference {text}: {fault}") from None
    signal = amplitude * form.shape(np.arange(frames) / rate, numbers) * tukey(frames, 2 * taper)
    return Reference(text, np.repeat(signal[:, None], outputs, axis=1), root, taper)


def is_file(text: str) -> bool:
    """Say whether `text` names a recording rather than a chirp or a sine."""
    return Path(text).suffix.lower() in (".wav", ".csv")


def is_one_tone(text: str) -> bool:
    """Say whether `text` names one tone at each time, whose overtones and phase can be told."""
    return not is_file(text) and FORMS[text.partition(":")[0]].is_one_tone


def sweep_of(text: str) -> tuple[float, float] | None:
    """Return first and last frequency, Hz, where `text` names a linear sweep."""
    kind, *numbers = text.split(":")
    return None if is_file(text) else FORMS[kind].sweep(list(map(float, numbers)))


def _numbers(text: str, kind: str, rest: str, rate: float) -> list[float]:
    names = FORMS[kind].numbers
    try:
        numbers = [float(part) for part in rest.split(":")]
    except ValueError:
        numbers = []
    if len(numbers) != len(names):
        raise ValueError(f"reference {text!r} is not {written(kind)}")
    for name, value in zip(names[:-1], numbers, strict=False):
        if not 0 < value < rate / 2:
            raise ValueError(f"reference {text}: {name} is {value:g} Hz, must be above 0 and below {rate / 2:g}")
    if not 0.1 <= numbers[-1] <= LONGEST:
        raise ValueError(f"reference {text}: SECONDS is {numbers[-1]:g}, must be 0.1 to {LONGEST:g}")
    return numbers


def _from_file(path: Path, text: str, rate: float, outputs: int, step: int, full_scale: float) -> Reference:
    data = open_signals(path, rate, asked="must be audio.rate,").whole().data
    if is_of_integers(path):
        if not full_scale > 0:
            raise ValueError(
                f"{path}: an integer WAV has no unit; reference.full_scale must state its full scale, > 0 m/s^2"
            )
        data = full_scale * data
    frames, width = data.shape
    if width not in (1, outputs):
        wanted = "1 channel" if outputs == 1 else f"1 or {outputs} channels"
        raise ValueError(f"{path}: {width} channels, must be {wanted}")
    if not 0.1 * rate <= frames <= LONGEST * rate:
        raise ValueError(f"{path}: {frames / rate:g} s, must be 0.1 to {LONGEST:g} s")
    if not np.any(data):
        raise ValueError(f"{path}: silent, must hold a reference")
    signal = np.zeros((-(-frames // step) * step, outputs))
    signal[:frames] = data
    return Reference(text, signal)
