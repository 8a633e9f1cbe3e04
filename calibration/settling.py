"""What the tone before leaves in a measured tone, as a share of the step between them."""

import numpy as np


def left_over(memory: np.ndarray, wait: np.ndarray, window: np.ndarray, rate: float) -> np.ndarray:
    """Return how much of a step still shows in a windowed tone, for a response that forgets exponentially.

    Parameters
    ----------
    memory : array, shape (bins,), s
        Time constant, see `refinement.memory`.
    wait : array, shape (bins, steps), s
        From the step to the window.
    window : array, shape (samples,), 1
    rate : float, samples/s

    Returns
    -------
    array, shape (bins, steps), 1
    """
    decay = 1 / np.maximum(memory, 1 / rate)
    inside = np.exp(-np.outer(decay, np.arange(len(window)) / rate)) @ window / window.sum()
    share: np.ndarray = np.exp(-wait * decay[:, None]) * inside[:, None]
    return share


def unsettled(response: np.ndarray, before: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Return the squared error that the tone before leaves in each element of the response.

    Parameters
    ----------
    response : complex array, shape (bins, outputs, inputs), any unit
    before : int array, shape (bins, inputs)
        Bin of the tone that the input carried before; -1 where it was at rest.
    share : array, shape (bins, inputs), 1
        See `left_over`.

    Returns
    -------
    array, shape (bins, outputs, inputs), the response's unit squared
    """
    inputs = np.arange(response.shape[2])
    last = np.where(before[:, None, :] < 0, 0.0, response[before, :, inputs].swapaxes(1, 2))
    error: np.ndarray = np.abs((response - last) * share[:, None, :]) ** 2
    return error
