"""The compiled kernel that takes a small turn of what the robot holds back."""

import numpy as np

from rigkit.compiled import njit

TURN = np.dtype(
    [
        ("now", "i8"),  # samples so far
        # between which the orientation is averaged
        ("first", "i8"),
        ("last", "i8"),
        ("gain", "f8"),  # of the integral, a sample; 0 never turns
        ("wanted", "f8", 4),  # w x y z; until `last` the sum of what was seen
        ("turn", "f8", 3),  # rad, asked of the robot
    ],
    align=True,
)


@njit(cache=True, nogil=True)
def run(orientation: np.ndarray, holding: np.ndarray, rotation: np.ndarray, turns: np.ndarray) -> None:
    """Run one frame: (frames, 4), (frames, 1) and (frames, 3)."""
    kept = turns[0]
    wanted, turn = kept.wanted, kept.turn
    for n in range(len(orientation)):
        seen = orientation[n]
        is_seen = 0.0 < np.sum(seen * seen) < np.inf
        if is_seen and kept.first <= kept.now < kept.last:
            sign = 1.0 if np.sum(wanted * seen) >= 0.0 else -1.0
            for number in range(4):
                wanted[number] += sign * seen[number]
        length = np.sqrt(np.sum(wanted * wanted) * np.sum(seen * seen)) if is_seen else 0.0
        if length > 0.0 and kept.now >= kept.last and holding[n, 0] < 0.5:
            step = 2.0 * kept.gain / length
            if np.sum(wanted * seen) < 0.0:
                step = -step
            # of seen (wanted)^-1, the vector part: half the turn that is to be taken back
            turn[0] -= step * (wanted[0] * seen[1] - seen[0] * wanted[1] - seen[2] * wanted[3] + seen[3] * wanted[2])
            turn[1] -= step * (wanted[0] * seen[2] - seen[0] * wanted[2] - seen[3] * wanted[1] + seen[1] * wanted[3])
            turn[2] -= step * (wanted[0] * seen[3] - seen[0] * wanted[3] - seen[1] * wanted[2] + seen[2] * wanted[1])
        rotation[n] = turn
        kept.now += 1
