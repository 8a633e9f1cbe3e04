"""From accelerometers to hydrophones: the measured transfer of the far field, and how late it is."""

from dataclasses import dataclass, replace

import numpy as np

from vibractl.transfer_matrix import TransferMatrix

UNITS = {"response": "Pa/(m/s^2)", "variance": "(Pa/(m/s^2))^2", "coherence": "1", "delay": "s"}


@dataclass(frozen=True)
class FarField:
    """T of P = T Y: what each hydrophone, or microphone in air, hears of what each accelerometer feels.

    Parameters
    ----------
    prompt : TransferMatrix
        T with each hydrophone's delay taken out, so that it can be interpolated: outputs are hydrophones, inputs are
        accelerometers, Pa per m/s^2.  `variance` and `coherence` are those of T's elements.
    delay : array, shape (hydrophones,), s, >= 0

    Raises
    ------
    ValueError : not as many delays as hydrophones, or one that is negative or not finite.
    """

    prompt: TransferMatrix
    delay: np.ndarray

    def __post_init__(self) -> None:
        """Refuse a delay that is none."""
        _refuse_wrong_delay(self.delay, self.prompt.outputs)

    @property
    def hydrophones(self) -> int:
        """Sensors in the far field."""
        return self.prompt.outputs

    @property
    def response(self) -> np.ndarray:
        """T with its delay, (bins, hydrophones, accelerometers), Pa per m/s^2."""
        return self.later(np.zeros(self.hydrophones))

    @property
    def late(self) -> TransferMatrix:
        """T with its delay, as it was measured."""
        return replace(self.prompt, response=self.response)

    def at(self, frequency: np.ndarray) -> "FarField":
        """Interpolate to other lines, shape (lines,), Hz; see `TransferMatrix.at`."""
        return FarField(self.prompt.at(frequency), self.delay)

    def later(self, start: np.ndarray) -> np.ndarray:
        """Return T as seen by who begins to listen later.

        Parameters
        ----------
        start : array, shape (hydrophones,), s

        Returns
        -------
        complex array, shape (bins, hydrophones, accelerometers), Pa per m/s^2
        """
        heard: np.ndarray = self.prompt.response * turned(self.prompt.frequency, self.delay - start)[..., None]
        return heard


def delayed(
    frequency: np.ndarray, response: np.ndarray, variance: np.ndarray, coherence: np.ndarray, delay: np.ndarray
) -> FarField:
    """Return the far field of a T that has its delay in it.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz
    response : complex array, shape (bins, hydrophones, accelerometers), Pa per m/s^2
    variance : array, shape (bins, hydrophones, accelerometers), (Pa per m/s^2)^2
    coherence : array, shape (bins, hydrophones, accelerometers), 0 to 1
    delay : array, shape (hydrophones,), s

    Raises
    ------
    ValueError : as for `FarField`.
    """
    _refuse_wrong_delay(delay, response.shape[1])
    prompt = response * turned(frequency, -delay)[..., None]
    return FarField(TransferMatrix(frequency, prompt, variance, coherence), delay)


def turned(frequency: np.ndarray, delay: np.ndarray) -> np.ndarray:
    """Return what delays do to lines.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz
    delay : array, shape (sensors,), s

    Returns
    -------
    complex array, shape (bins, sensors), 1
    """
    phase: np.ndarray = np.exp(-2j * np.pi * np.outer(frequency, delay))
    return phase


def _refuse_wrong_delay(delay: np.ndarray, hydrophones: int) -> None:
    if delay.shape != (hydrophones,) or not (np.isfinite(delay) & (delay >= 0)).all():
        raise ValueError(f"the delays of {hydrophones} hydrophones are {delay.tolist()} s, must be as many, >= 0")
