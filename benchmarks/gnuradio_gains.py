"""GNU Radio's chain of ten gains, in Debian's Python: for a line with samples and buffer, one with two times in s."""

import sys
import time

from gnuradio import blocks, gr

LARGEST = 64
"""Samples a call."""


def run(samples: int, buffer: int) -> tuple[float, float]:
    """Push `samples` zeros through, at most `buffer` between two blocks, and return s by the clock and on all cores."""
    top = gr.top_block()
    chain = [blocks.null_source(gr.sizeof_float), blocks.head(gr.sizeof_float, samples)]
    chain += [blocks.multiply_const_ff(1.0 + n / 8) for n in range(10)]
    for block in chain:
        block.set_max_output_buffer(buffer)
    sink = blocks.null_sink(gr.sizeof_float)
    top.connect(*chain, sink)
    clock, cores = time.perf_counter(), time.process_time()
    top.start(LARGEST)
    top.wait()
    taken = time.perf_counter() - clock, time.process_time() - cores
    assert sink.nitems_read(0) == samples
    return taken


print(gr.version(), flush=True)
for line in sys.stdin:
    print(*run(*map(int, line.split())), flush=True)
