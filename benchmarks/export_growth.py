"""What `vibractl export` costs, by format and number of shots: seconds of processor, peak memory, bytes.

The run is made on the simulated vibrator, shots of 1.6 s; every export is a process of its own.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks.page_table import FLAG, put, table
from tests.vibractl.linear_rig import linear_config, linear_model
from vibractl.export.run import FORMATS
from vibractl.run_setup import create
from vibractl.session import Session

CHILD = """
import os, pathlib
from vibractl.__main__ import main
assert main() == 0
status = dict(line.split(":") for line in pathlib.Path("/proc/self/status").read_text().splitlines())
print(sum(os.times()[:2]), status["VmHWM"].split()[0])
"""
"""An export that ends with what it took: s, kB.  Linux counts the parent's memory into a child's `ru_maxrss`."""


def recorded(folder: Path, shots: int) -> Path:
    """Make a run of so many shots and return its folder."""
    run, made = create(folder / "run", linear_config(f"session.shots={shots}"), linear_model(folder))
    with run:
        session = Session(run, made)
        session.run(shots, lambda *_: None, lambda: False)
        session.summary()
    return run.path


def cost(run: Path, name: str, shots: int) -> tuple[float, float, float]:
    """Export in one format; return seconds of processor, peak memory and size, MB."""
    with tempfile.TemporaryDirectory() as out:
        command = ["export", str(run), "--to", name, "--shots", f"0-{shots - 1}", "--out", out]
        child = subprocess.run([sys.executable, "-c", CHILD, *command], stdout=subprocess.PIPE, check=True, text=True)
        seconds, peak = map(float, child.stdout.splitlines()[-1].split())
        size = sum(file.stat().st_size for file in Path(out).iterdir())
    return seconds, peak * 1.024e-3, size * 1e-6


def main() -> None:
    """Measure each format at a tenth of the shots and at all of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shots", type=int, default=300)
    parser.add_argument(FLAG, action="store_true", help="put the table into docs/export.md")
    shots = parser.parse_args().shots
    counts = (shots // 10, shots)
    with tempfile.TemporaryDirectory() as folder:
        run = recorded(Path(folder), shots)
        rows = []
        for name in FORMATS:
            few, all_of_them = (cost(run, name, count) for count in counts)
            pairs = zip(("{:.1f}", "{:.0f}", "{:.0f}"), few, all_of_them, strict=True)
            rows.append([f"`{name}`", *(form.format(value) for form, *values in pairs for value in values)])
    head = ["format", *(f"{what}, {count} shots" for what in ("CPU s", "peak MB", "file MB") for count in counts)]
    put(table(head, rows), "export.md", "growth")


if __name__ == "__main__":
    main()
