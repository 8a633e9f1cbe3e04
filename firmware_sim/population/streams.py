"""A random stream for each property of a machine: drawing one more property does not redraw the rest."""

import hashlib

import numpy as np

WORDS = 4
"""32-bit words of a name's hash: two names share a stream once in 2^128."""


class Streams:
    """Random numbers by name, the same on every machine.

    A stream is that of numpy's PCG64 from the seed, spawned by the SHA-256 of the names on the way to it.

    Parameters
    ----------
    seed : int, >= 0
    *names : str
        Whose properties these are, such as a kind and a family.

    Examples
    --------
    >>> mass = Streams(7, "vibrator", "lumped")("mass")
    >>> mass.uniform() == Streams(7, "vibrator", "lumped")("mass").uniform()
    True
    """

    def __init__(self, seed: int, *names: str) -> None:
        if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
            raise ValueError(f"seed is {seed!r}, must be a whole number >= 0")
        self._seed, self._names = seed, names

    def __call__(self, name: str) -> np.random.Generator:
        """Return the stream of one property, from its beginning."""
        digest = hashlib.sha256("/".join((*self._names, name)).encode()).digest()
        words = tuple(int.from_bytes(digest[4 * n : 4 * n + 4], "little") for n in range(WORDS))
        return np.random.Generator(np.random.PCG64(np.random.SeedSequence(self._seed, spawn_key=words)))

    def within(self, name: str) -> "Streams":
        """Return the streams of a part of the machine."""
        return Streams(self._seed, *self._names, name)
