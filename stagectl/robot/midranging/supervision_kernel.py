"""The compiled watch over a loop's model: the small-gain condition that internal model control diverges beyond."""

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from rigkit.record import Record


@njit(cache=True, nogil=True)
def begin(loop: Record) -> None:
    """Forget what was watched."""
    loop.error_mean = loop.error_power = loop.output_mean = loop.output_power = 0.0
    loop.suspicion = 0


@njit(cache=True, nogil=True)
def is_diverging(loop: Record, most: float, least: float, measured: float, modelled: float) -> bool:
    """Take a sample in, m, and return whether the model's error has been larger than `most` times its output for long.

    Means apart, rms, and `least` (m) in any case.  At the frequency of a growing oscillation, F T (H - H^) / H^ = -1:
    the error over the output is 1 / |F T|, which is at least one.
    """
    keep, error = float(loop.window_pole), measured - modelled
    error_mean = float(flushed(keep * loop.error_mean + (1.0 - keep) * error))
    output_mean = float(flushed(keep * loop.output_mean + (1.0 - keep) * modelled))
    error_power = float(flushed(keep * loop.error_power + (1.0 - keep) * (error - error_mean) ** 2))
    output_power = float(flushed(keep * loop.output_power + (1.0 - keep) * (modelled - output_mean) ** 2))
    loop.error_mean, loop.output_mean = error_mean, output_mean
    loop.error_power, loop.output_power = error_power, output_power
    if error_power > most * most * output_power + least * least:
        loop.suspicion += 1
    elif loop.suspicion > 0:
        loop.suspicion -= 1
    return bool(loop.suspicion * (1.0 - keep) > 1.0)
