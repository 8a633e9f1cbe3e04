"""The compiled kernel that makes a relative position of a slow, noisy tracker and a quick, quiet stage."""

from numba import njit

from rigkit.flush_kernel import flushed


@njit(cache=True, nogil=True)
def run(spindle, workpiece, wanted, position, absolute, deviation, line, memory, clock, by_laser, pole, first, last):  # type: ignore[no-untyped-def]
    """Run one frame: shape (frames, 3) each, m; `line` holds what the quick sensors last saw.

    `memory` (4, 3): sums of what tracker and quick sensors see while all stands still, samples `first` to `last`, and
    two low-passes in a row, m.  `clock[0]` counts samples; `by_laser` (3,) says which axes have one.
    """
    for n in range(len(spindle)):
        now = clock[0]
        slot = now % len(line)
        for axis in range(3):
            quick = absolute[n, axis] if by_laser[axis] else position[n, axis]
            before = line[slot, axis] if now >= len(line) else quick
            line[slot, axis] = quick
            seen = spindle[n, axis] - workpiece[n, axis] - wanted[n, axis] - before
            deviation[n, axis] = 0.0
            if now < last:
                if now >= first:
                    memory[0, axis] += seen / (last - first)
                    memory[1, axis] += quick / (last - first)
                continue
            smooth = memory[2, axis] + (1.0 - pole[axis]) * (seen - memory[0, axis] - memory[2, axis])
            memory[2, axis] = flushed(smooth)
            memory[3, axis] = flushed(memory[3, axis] + (1.0 - pole[axis]) * (memory[2, axis] - memory[3, axis]))
            deviation[n, axis] = memory[3, axis] + quick - memory[1, axis]
        clock[0] += 1
