"""Sound from shells to other shells and to hydrophones: a gain and a delay for each path."""

import numpy as np

from rigkit.compiled import njit


class SoundPaths:
    """Let shells move each other and be heard afar, in frames of any length with the same result bit for bit.

    Parameters
    ----------
    between : array, shape (shells, shells), m/s^2 per m/s^2
        To each shell from each.
    between_delay : int array, shape (shells, shells), samples
    far : array, shape (hydrophones, shells), Pa per m/s^2
    far_delay : int array, shape (hydrophones, shells), samples
    frames : int, samples
        Longest frame.
    """

    def __init__(
        self,
        between: np.ndarray,
        between_delay: np.ndarray,
        far: np.ndarray,
        far_delay: np.ndarray,
        frames: int,
    ) -> None:
        self._paths = between, between_delay, far, far_delay
        self._longest = int(max(between_delay.max(), far_delay.max()))
        self._past = np.zeros((2, len(between), 2 * self._longest + 8 * frames))
        self._end = self._longest

    def run(self, shells: np.ndarray, far_field: np.ndarray) -> None:
        """Add to how shells move what others do to them, and to what is heard what they all do in the end.

        Parameters
        ----------
        shells : array, shape (vibrators, frames, 2), m/s^2
        far_field : array, shape (frames, hydrophones), Pa
        """
        frames = shells.shape[1]
        if self._end + frames > self._past.shape[2]:
            for shell in self._past.reshape(-1, self._past.shape[2]):  # one by one, since numpy would copy them all
                shell[: self._longest] = shell[self._end - self._longest : self._end]
            self._end = self._longest
        _spread(shells, self._past, self._end, self._paths, far_field)
        self._end += frames


@njit(cache=True, nogil=True)
def _spread(
    shells: np.ndarray, past: np.ndarray, now: int, paths: tuple[np.ndarray, ...], far_field: np.ndarray
) -> None:
    """Go on from column `now` of `past` (2, shells, samples): how shells move without and with others."""
    alone, together = past[0], past[1]
    between, between_delay, far, far_delay = paths
    frames = shells.shape[1]
    for shell in range(len(between)):
        for n in range(frames):
            alone[shell, now + n] = shells[shell // 2, n, shell % 2]
    for shell in range(len(between)):
        moved = together[shell, now : now + frames]
        moved[:] = alone[shell, now : now + frames]
        for other in range(len(between)):
            if between[shell, other] != 0.0:
                _add(moved, between[shell, other], alone[other], now - between_delay[shell, other])
        for n in range(frames):
            shells[shell // 2, n, shell % 2] = moved[n]
    for hydrophone in range(len(far)):
        for shell in range(len(between)):
            start = now - far_delay[hydrophone, shell]
            for n in range(frames):
                far_field[n, hydrophone] += far[hydrophone, shell] * together[shell, start + n]


@njit(cache=True, nogil=True)
def _add(total: np.ndarray, gain: float, signal: np.ndarray, start: int) -> None:
    for n in range(len(total)):
        total[n] += gain * signal[start + n]
