"""Damaged files, one after the other, in a process that may die: `python -m tests.fuzz.child KIND FOLDER FIRST COUNT`.

A case that takes more than a second of the processor's time, or memory beyond 1 GiB over what the program has anyway,
is a finding like a wrong error, and so is one that kills the process: its number is in FOLDER/at.  Prints the number of
files accepted, and then each finding on a line.
"""

import importlib
import os
import resource
import signal
import sys
import warnings
from pathlib import Path

from tests.fuzz.judge import Finding

KINDS = {
    "wav": "tests.fuzz.wav_cases:cases",
    "growing": "tests.fuzz.wav_cases:growing_cases",
    "csv": "tests.fuzz.csv_cases:cases",
    "foreign": "tests.fuzz.csv_cases:foreign_cases",
    "sounds": "tests.fuzz.foreign_cases:sound_cases",
    "tables": "tests.fuzz.foreign_cases:table_cases",
    "arrays": "tests.fuzz.foreign_cases:array_cases",
    "toml": "tests.fuzz.toml_cases:cases",
    "json": "tests.fuzz.json_cases:cases",
    "can": "tests.fuzz.can_cases:cases",
    "wires": "tests.fuzz.wire_cases:cases",
    "hdf5": "tests.fuzz.hdf5_cases:cases",
    "mcap": "tests.fuzz.mcap_cases:cases",
}
SECONDS, MEMORY = 1.0, 2**30
MOST_FINDINGS = 20


def main(kind: str, folder: Path, first: int, count: int) -> None:
    module, _, name = KINDS[kind].partition(":")
    case = getattr(importlib.import_module(module), name)(folder)
    warnings.simplefilter("error")
    accepted = _judged(case, first)  # and whatever is loaded late
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * os.sysconf("SC_PAGE_SIZE") + MEMORY,) * 2)
    at = os.open(folder / "at", os.O_WRONLY | os.O_CREAT)
    for number in range(first + 1, first + count):
        os.pwrite(at, f"{number:12d}".encode(), 0)
        signal.setitimer(signal.ITIMER_PROF, SECONDS)  # kills: a parser in C would hear nothing else
        accepted += _judged(case, number)
    signal.setitimer(signal.ITIMER_PROF, 0)
    sys.stdout.write(f"{accepted}\n{''.join(_findings)}")


_findings: list[str] = []


def _judged(case: object, number: int) -> bool:
    try:
        return bool(case(number))  # type: ignore[operator]
    except Finding as finding:
        _findings.append(f"{number}: {' '.join(str(finding).split())[:300]}\n")
        if len(_findings) >= MOST_FINDINGS:
            sys.stdout.write(f"0\n{''.join(_findings)}")
            sys.exit()
        return False


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]))
