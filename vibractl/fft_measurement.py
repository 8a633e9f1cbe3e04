"""FFT plans measured by FFTW in a process of its own, which can be ended in the middle of one."""

import multiprocessing
import signal
from collections.abc import Iterator, Sequence
from multiprocessing.connection import Connection

from vibractl.fft_plans import Plans
from vibractl.fft_transform import Transform

_LOOK = 0.2
"""s between two looks at that process."""


def measured(wisdom: bytes, sizes: Sequence[Transform]) -> Iterator[bytes | None]:
    """Measure the plans of transforms one after the other; the process ends with the iteration.

    Parameters
    ----------
    wisdom : bytes
        FFTW's own text: what is in it is not measured again.
    sizes : sequence of Transform

    Yields
    ------
    bytes or None
        The wisdom with one more transform each time that one is done; None in between, a few times a second.

    Raises
    ------
    OSError : the process has ended before its time, as for want of memory.
    """
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_measure, args=(wisdom, list(sizes), sender), name="fft plans", daemon=True)
    process.start()
    sender.close()
    try:
        for _ in sizes:
            while not receiver.poll(_LOOK):
                yield None
            yield receiver.recv()
    except EOFError:
        process.join()
        raise OSError(f"the process that measures FFT plans has died, exit code {process.exitcode}") from None
    finally:
        process.kill()
        process.join()
        receiver.close()


def _measure(wisdom: bytes, sizes: Sequence[Transform], sender: Connection) -> None:
    """Send the wisdom after each transform: the child process' whole life."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the program, which then ends this process
    plans = Plans(wisdom)
    for size in sizes:
        plans.planned(size, "FFTW_MEASURE")
        sender.send(plans.wisdom)
