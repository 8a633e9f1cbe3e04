"""Large arrays that are freed are given back to the machine, whatever lies beside them."""

import subprocess
import sys
from pathlib import Path

import pytest

LEFT = """
import sys
import numpy as np
from rigkit.large_arrays import LARGE, give_back_large_arrays

def resident():
    return 4096 * int(open("/proc/self/statm").read().split()[1])

if sys.argv[1] == "back":
    give_back_large_arrays()
for _ in range(3):
    np.ones(2 * LARGE // 8)  # from here on the library would take such arrays to the heap
before = resident()
held = [np.ones(2 * LARGE // 8) for _ in range(20)]
del held[::2]
print((resident() - before) / (2 * LARGE))
"""


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc/self/statm on this system")
def test_every_other_of_twenty_arrays_is_given_back() -> None:
    command = [sys.executable, "-c", LEFT]
    back, kept = (
        float(subprocess.run([*command, how], capture_output=True, check=True).stdout) for how in ("back", "kept")
    )
    assert 9.0 < back < 11.0 < kept
