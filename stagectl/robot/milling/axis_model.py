"""How the robot follows its path along one direction: G_R, a model of third order behind a delay."""

from dataclasses import dataclass

import numpy as np

ORDER = 3


@dataclass(frozen=True, eq=False)
class AxisModel:
    """From a coordinate of the path that is sent to the same coordinate as the motors' angles have it.

    G(z) = z^-delay (b_1 z^2 + b_2 z + b_3) / (z^3 + a_1 z^2 + a_2 z + a_3)

    Parameters
    ----------
    numerator : array, shape (3,), 1
    denominator : array, shape (4,), 1
        Begins with 1; its zeros are within the unit circle.
    delay : int, samples, >= 0
    rate : float, samples/s

    Raises
    ------
    ValueError : other shapes, a value that is not finite, a pole that is not stable, no gain at rest.

    Source
    ------
    Sörnmo 2015, sec. 5.2: "third-order discrete-time dynamic models".

    Departs
    -------
    The delay counts beside the order: guided motion alone has several samples of it.
    """

    numerator: np.ndarray
    denominator: np.ndarray
    delay: int
    rate: float

    def __post_init__(self) -> None:
        """Refuse what is no such model."""
        b, a = (np.array(each, float) for each in (self.numerator, self.denominator))
        if b.shape != (ORDER,) or a.shape != (ORDER + 1,) or not np.isfinite([*b, *a]).all() or a[0] != 1.0:
            raise ValueError(f"numerator {b} and denominator {a} must be {ORDER} and {ORDER + 1} numbers, 1 first")
        if not np.abs(np.roots(a)).max() < 1:
            raise ValueError(f"its slowest pole has modulus {np.abs(np.roots(a)).max():.6g}, must be < 1")
        if not abs(b.sum()) > 0:
            raise ValueError("it has no gain at rest: it cannot be inverted")
        object.__setattr__(self, "numerator", b)
        object.__setattr__(self, "denominator", a)

    def response(self, frequency: np.ndarray) -> np.ndarray:
        """Return its frequency response, complex, shape (bins,), 1, at frequencies, shape (bins,), Hz."""
        turn = np.exp(2j * np.pi * np.asarray(frequency, float) / self.rate)
        found: np.ndarray = turn**-self.delay * np.polyval(self.numerator, turn) / np.polyval(self.denominator, turn)
        return found


def robot_response(axes: tuple[AxisModel, ...], frequency: np.ndarray) -> np.ndarray:
    """Return G_R of all directions, complex, diagonal, shape (bins, axes, axes), 1.

    Parameters
    ----------
    axes : tuple of AxisModel
    frequency : array, shape (bins,), Hz
    """
    return diagonal([axis.response(frequency) for axis in axes])


def diagonal(responses: list[np.ndarray]) -> np.ndarray:
    """Put responses, each of shape (bins,), on the diagonal of one, complex, shape (bins, n, n)."""
    found: np.ndarray = np.stack(responses, axis=-1)[..., None] * np.eye(len(responses))
    return found
