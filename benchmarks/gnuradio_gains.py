"""GNU Radio's chain of ten gains, in Debian's Python: for a number of samples a line, two times in s."""

import sys
import time

from gnuradio import blocks, gr

LARGEST = 64
"""Samples a call."""


def run(samples: int) -> tuple[float, float]:
    """Push `samples` zeros through and return the time by the clock and on all cores, s."""
    top = gr.top_block()
    gains = [blocks.multiply_const_ff(1.0 + n / 8) for n in range(10)]
    sink = blocks.null_sink(gr.sizeof_float)
    top.connect(blocks.null_source(gr.sizeof_float), blocks.head(gr.sizeof_float, samples), *gains, sink)
    clock, cores = time.perf_counter(), time.process_time()
    top.start(LARGEST)
    top.wait()
    taken = time.perf_counter() - clock, time.process_time() - cores
    assert sink.nitems_read(0) == samples
    return taken


print(gr.version(), flush=True)
for line in sys.stdin:
    print(*run(int(line)), flush=True)
