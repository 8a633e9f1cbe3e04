"""The tone by which a relay outside knows that the program stands up for what it plays."""

import numpy as np

HEARTBEAT = 1000.0
"""Hz, about."""


def heartbeat(rate: int, frames: int) -> np.ndarray:
    """Return the tone (frames,), full scale, that says that all is well: about 1 kHz, whole periods in every block.

    Parameters
    ----------
    rate : int, samples/s
    frames : int, samples a callback
    """
    periods = max(1, round(HEARTBEAT * frames / rate))
    tone: np.ndarray = (0.5 * np.sin(2 * np.pi * periods * np.arange(frames) / frames)).astype(np.float32)
    return tone
