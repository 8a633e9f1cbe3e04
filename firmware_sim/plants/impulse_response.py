"""A linear plant from measured impulse responses: convolution without added latency, in frames of any length."""

import numpy as np

from rigkit.compiled import njit

BLOCK = 256
"""Samples convolved directly; what is older goes through partitions of this length in the frequency domain."""


class ImpulseResponsePlant:
    """Convolve every drive with its impulse response to every accelerometer, and add up.

    The first `BLOCK` taps are convolved directly, sample by sample; the rest by uniformly partitioned overlap-save,
    whose blocks end every `BLOCK` samples wherever the frames end.  So the result does not depend on the frames,
    bit for bit, and nothing is delayed.

    Not modelled: anything nonlinear, noise, hum, drift, and what the impulse response was cut off from.

    Parameters
    ----------
    responses : array, shape (taps, outputs, inputs), m/s^2 per V, a sample
        Finite; at least one tap.
    """

    def __init__(self, responses: np.ndarray) -> None:
        if responses.ndim != 3 or 0 in responses.shape or not np.all(np.isfinite(responses)):
            raise ValueError(
                f"impulse responses have shape {responses.shape}, must be (taps, outputs, inputs), all >= 1, and finite"
            )
        taps, outputs, inputs = responses.shape
        parts = -(-taps // BLOCK)
        padded = np.zeros((parts, BLOCK, outputs, inputs))
        padded.reshape(-1, outputs, inputs)[:taps] = responses
        self._head = np.ascontiguousarray(padded[0].transpose(1, 2, 0))
        spectra = np.fft.rfft(padded[1:], 2 * BLOCK, axis=1) / (2 * BLOCK)
        self._partitions = np.ascontiguousarray(spectra.transpose(0, 2, 3, 1))
        self._past = np.zeros((max(parts - 1, 1), inputs, BLOCK + 1), complex)
        self._recent = np.zeros((inputs, 2 * BLOCK))
        self._product = np.zeros((outputs, BLOCK + 1), complex)
        self._tail = np.zeros((outputs, 2 * BLOCK))
        self._total = np.zeros(BLOCK)
        self._position = 0
        self._newest = 0

    def run(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Go on for `drive`, (frames, inputs) V, and fill `response`, (frames, outputs) m/s^2."""
        start = 0
        while start < len(drive):
            end = min(len(drive), start + BLOCK - self._position)
            _head(
                drive[start:end], self._recent, self._head, self._tail, self._total, self._position, response[start:end]
            )
            self._position += end - start
            start = end
            if self._position == BLOCK:
                self._end_block()

    def reset(self) -> None:
        """Forget all drives."""
        self._past.fill(0.0)
        self._recent.fill(0.0)
        self._tail.fill(0.0)
        self._position = self._newest = 0

    def _end_block(self) -> None:
        if len(self._partitions):
            self._newest = (self._newest - 1) % len(self._past)
            np.fft.rfft(self._recent, axis=1, out=self._past[self._newest])
            _tail(self._past, self._newest, self._partitions, self._product)
            np.fft.irfft(self._product, 2 * BLOCK, axis=1, norm="forward", out=self._tail)
        self._recent[:, :BLOCK] = self._recent[:, BLOCK:]
        self._position = 0


@njit(cache=True, nogil=True)
def _head(
    drive: np.ndarray,
    recent: np.ndarray,
    head: np.ndarray,
    tail: np.ndarray,
    total: np.ndarray,
    position: int,
    response: np.ndarray,
) -> None:
    """Convolve the newest taps directly and add the tail made when the last block ended."""
    frames, now = len(drive), BLOCK + position
    for source in range(head.shape[1]):
        for n in range(frames):
            recent[source, now + n] = drive[n, source]
    for output in range(head.shape[0]):
        for n in range(frames):
            total[n] = tail[output, now + n]
        for source in range(head.shape[1]):
            for tap in range(BLOCK):
                gain = head[output, source, tap]
                delayed = recent[source, now - tap : now - tap + frames]
                for n in range(frames):
                    total[n] += gain * delayed[n]
        for n in range(frames):
            response[n, output] = total[n]


@njit(cache=True, nogil=True)
def _tail(past: np.ndarray, newest: int, partitions: np.ndarray, product: np.ndarray) -> None:
    """Multiply the blocks of the past with their partitions: shape (outputs, lines)."""
    product[:, :] = 0.0
    for part in range(len(partitions)):
        block = past[(newest + part) % len(past)]
        for output in range(partitions.shape[1]):
            for source in range(partitions.shape[2]):
                for line in range(partitions.shape[3]):
                    product[output, line] += partitions[part, output, source, line] * block[source, line]
