"""A hundred shots through a real-time JACK server while both cores, and this very process, are kept busy.

Run as root (the server asks for real-time priority):  python -m benchmarks.audio_load [--in-process]
"""

import argparse
import multiprocessing
import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from benchmarks.jack_server import jack_server, missing, vibrator_client
from vibractl.audio import Line
from vibractl.capture import Discarded
from vibractl.config import Audio, RigConfig

RATE = 44_100
SECONDS = 5.6


def work(until: Callable[[], bool] = lambda: False) -> None:
    """Keep a core busy: transforms, and Python objects that the garbage collector has to look at."""
    random = np.random.default_rng(os.getpid())
    while not until():
        spectrum = np.fft.rfft(random.standard_normal(220_500))
        keep = [{"line": n, "level": float(abs(value))} for n, value in enumerate(spectrum[:50_000])]
        keep.clear()


@contextmanager
def busy(processes: int) -> Iterator[None]:
    """Run so many busy processes, and a busy thread in this one."""
    done = threading.Event()
    thread = threading.Thread(target=work, args=(done.is_set,), daemon=True)
    thread.start()
    workers = [multiprocessing.get_context("spawn").Process(target=work, daemon=True) for _ in range(processes)]
    for worker in workers:
        worker.start()
    try:
        yield
    finally:
        done.set()
        thread.join()
        for worker in workers:
            worker.kill()
            worker.join()


def measure(shots: int, period: int, isolated: bool, options: list[str], load: int) -> None:
    """Play the shots and print what became of them."""
    audio = Audio(stream="sounddevice:Stream", device="shaker", blocksize=period, isolated=isolated, attempts=20)
    time_axis = np.arange(round(SECONDS * RATE)) / RATE
    tones = np.sin(2 * np.pi * np.array([47.0, 71.0]) * time_axis[:, None])
    drive = 3.0 * tones * np.sin(np.pi * time_axis / SECONDS)[:, None] ** 2
    discards: list[Discarded] = []
    delays, residuals, late = [], [], 0
    before = stolen()
    with jack_server(options, RATE, period), vibrator_client([]), busy(load):
        with Line(RigConfig(audio=audio), on_discard=discards.append) as line:
            begin = time.monotonic()
            for _ in range(shots):
                capture = line.emit(drive)
                late += capture.late
                delays.append(capture.delay)
                residuals.append(abs(capture.residual))
        seconds = time.monotonic() - begin
    where = "own process" if isolated else "this process"
    xruns = sum(found.capture.input_xruns for found in discards)
    print(f"jackd {' '.join(options)} -p {period}, {where}, {load} busy processes on {os.cpu_count()} cores")
    print(f"  {shots} shots of {SECONDS} s in {seconds:.0f} s: {len(discards)} discarded, {xruns} xruns, {late} late")
    print(f"  round trip {min(delays):.3f} to {max(delays):.3f} samples, residual {max(residuals):.2g}")
    print(f"  taken from this machine by its host meanwhile: {stolen() - before:.2f} s of processor time")
    for found in discards:
        print(f"  discarded: {found.reason}", flush=True)


def stolen() -> float:
    """Return the processor time, s, for which a virtual machine's host let its processors stand still."""
    with open("/proc/stat") as file:
        return int(file.readline().split()[8]) / os.sysconf("SC_CLK_TCK")


def main() -> None:
    """Read the options and measure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shots", type=int, default=100)
    parser.add_argument("--period", type=int, default=2048)
    parser.add_argument("--load", type=int, default=2, help="busy processes")
    parser.add_argument("--in-process", action="store_true", help="audio.isolated = false")
    parser.add_argument("--ordinary", action="store_true", help="jackd -r -S, without real-time priority")
    options = parser.parse_args()
    if missing():
        raise SystemExit(f"skipped: {missing()}")
    server = ["-r", "-S"] if options.ordinary else ["-R", "-P70", "-S"]
    measure(options.shots, options.period, not options.in_process, server, options.load)
    if options.in_process:
        os._exit(0)  # PortAudio aborts at the end of a process whose JACK server ended before


if __name__ == "__main__":
    main()
