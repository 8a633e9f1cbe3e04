"""One MIMO update at 5 s, 44.1 kHz, against the bare transforms and against vectorised numpy, in one run."""

from collections.abc import Callable
from statistics import median
from time import perf_counter

import numpy as np
import pyfftw

from vibractl.fft_plans import Plans
from vibractl.learning.update import update
from vibractl.spectrum import LineSpectrum
from vibractl.transfer_matrix import regularized_inverse

FRAMES, RATE, ROUNDS = 220_500, 44_100.0, 25


def seconds(*jobs: Callable[[], object]) -> list[float]:
    """Return each job's median time, the jobs taken in turn."""
    times: list[list[float]] = [[] for _ in jobs]
    for _ in range(ROUNDS):
        for job, taken in zip(jobs, times, strict=True):
            start = perf_counter()
            job()
            taken.append(perf_counter() - start)
    return [median(taken) for taken in times]


def jobs() -> tuple[Callable[[], None], Callable[[], None], Callable[[], None]]:
    """Return the update as ours, the bare transforms, and the update in vectorised numpy."""
    rng = np.random.default_rng(1)
    spectrum = LineSpectrum(FRAMES, 2, RATE, (15.0, 650.0), Plans())
    lines = len(spectrum.frequency)
    response = rng.standard_normal((lines, 2, 2)) + 1j * rng.standard_normal((lines, 2, 2))
    inverse = regularized_inverse(response, 1e-3)
    error, drive = rng.standard_normal((FRAMES, 2)), np.zeros((lines, 2), complex)
    played = np.zeros((FRAMES, 2))

    def ours() -> None:
        spectrum.time(update(drive, inverse, spectrum.lines(error), 0.3), played)

    time, bins = pyfftw.empty_aligned((2, FRAMES)), pyfftw.empty_aligned((2, FRAMES // 2 + 1), complex)
    flags = ("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT")
    forward = pyfftw.FFTW(time, bins, axes=(1,), flags=flags)
    backward = pyfftw.FFTW(bins, time, axes=(1,), direction="FFTW_BACKWARD", flags=flags)
    time[:] = error.T

    def bare() -> None:
        forward.execute()
        backward.execute()

    everywhere = np.tile(np.eye(2) + 0j, (FRAMES // 2 + 1, 1, 1))
    everywhere[75 : 75 + lines] = response
    band = np.zeros(FRAMES // 2 + 1)
    band[75 : 75 + lines] = 0.3
    before = np.zeros((FRAMES // 2 + 1, 2), complex)

    def vectorised() -> None:
        step = np.linalg.solve(everywhere, np.fft.rfft(error, axis=0)[..., None])[..., 0]
        np.fft.irfft(before + band[:, None] * step, FRAMES, axis=0)

    return ours, bare, vectorised


def test_one_mimo_update(benchmark) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    """Print the ratios; FFTs, inverse on the lines used, update, inverse FFT."""
    ours, bare, vectorised = jobs()
    whole, transforms, numpys = seconds(ours, bare, vectorised)
    benchmark.extra_info["ms"] = round(whole * 1e3, 2)
    print(
        f"\nupdate {whole * 1e3:.2f} ms: {whole / transforms:.2f} x the bare pyfftw transforms "
        f"({transforms * 1e3:.2f} ms), {numpys / whole:.1f} x as fast as vectorised numpy ({numpys * 1e3:.1f} ms)"
    )
    benchmark(ours)
