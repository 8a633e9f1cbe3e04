"""docs/peers.md: what this program does beside others, measured in one run.

`python -m benchmarks.peers [--write]`, two minutes; `--write` keeps what was measured in docs/peers.json and writes the
page.  Packages that are not installed (`pip install -e '.[peers]'`) are rows that say so.
"""

import sys

from benchmarks.machine import machine
from benchmarks.page_table import DOCS, FLAG
from benchmarks.peers import ilc_laws, midranging, planners
from benchmarks.peers.page import page
from benchmarks.test_update_speed import jobs, seconds
from rigkit import atomic
from rigkit.json_text import json_text
from rigkit.provenance import now, software

KEPT, PAGE = DOCS / "peers.json", DOCS / "peers.md"
PACKAGES = ("numpy", "scipy", "control", "networkx")


def updates() -> list[list[str]]:
    """Return what an update takes, and what its parts and numpy take."""
    ours, bare, vectorised = seconds(*jobs())
    named = (("ours", ours), ("the bare transforms, pyfftw", bare), ("vectorised numpy", vectorised))
    return [[name, f"{1e3 * spent:.1f}", f"{spent / ours:.2f}"] for name, spent in named]


def main() -> None:
    """Measure, print, and keep where that is asked for."""
    kept = {
        "time": now(),
        "machine": machine(),
        "software": software(PACKAGES),
        "laws": ilc_laws.rows(),
        "updates": updates(),
        "midranging": midranging.rows(),
        "planners": planners.rows(),
        "learned": planners.learned(),
    }
    print(page(kept))
    if FLAG in sys.argv:
        atomic.write(KEPT, f"{json_text(kept, indent=2)}\n")
        atomic.write(PAGE, page(kept))


if __name__ == "__main__":
    main()
