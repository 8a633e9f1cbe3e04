"""What a machine is, and how busy: processor, memory, load, clock, versions of libraries; nobody's names."""

import os
import platform
import sys
import time
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import Any

from rigkit.provenance import now, software

_CLOCK = Path("/sys/devices/system/clocksource/clocksource0/current_clocksource")
_GOVERNOR = Path("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")
_PROCESSOR = Path("/proc/cpuinfo")
_MEMORY = Path("/proc/meminfo")


def machine_facts() -> dict[str, Any]:
    """Return what is known of this machine and program, by name; what the system does not tell is left out."""
    facts: dict[str, Any] = {
        "software": software(),
        "when": now(),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "python": sys.version,
        "processor": processor(),
        "cores": os.cpu_count(),
        "memory": _line(_MEMORY, "MemTotal"),
        "governor": _text(_GOVERNOR),
        "load": list(os.getloadavg()) if hasattr(os, "getloadavg") else None,
        "clock": {
            "source": _text(_CLOCK),
            "monotonic_resolution": time.get_clock_info("monotonic").resolution,
            "sleep_of_1_ms": _sleeps(),
        },
        "libraries": libraries(),
    }
    return {name: fact for name, fact in facts.items() if fact not in (None, "")}


def processor() -> str:
    """Return its maker's name for it, where the system knows."""
    return _line(_PROCESSOR, "model name") or platform.processor() or platform.machine()


def libraries() -> dict[str, str]:
    """Return the versions of all packages that this program can use; of those that are missing, "missing"."""
    found = {}
    for line in requires("vibrostage") or ():
        name = "".join(each if each.isalnum() or each in "-_." else " " for each in line).split()[0]
        if "extra ==" not in line or "export" in line or "jack" in line or "cluster" in line:
            try:
                found[name] = version(name)
            except PackageNotFoundError:
                found[name] = "missing"
    return found


def _sleeps(times: int = 50) -> dict[str, float]:
    """Return how long a sleep of 1 ms takes on this machine now, s."""
    taken = []
    for _ in range(times):
        began = time.perf_counter()
        time.sleep(1e-3)
        taken.append(time.perf_counter() - began)
    return {"median": sorted(taken)[times // 2], "worst": max(taken)}


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8").strip()
    except OSError:
        return ""


def _line(path: Path, name: str) -> str:
    lines = (line.partition(":") for line in _text(path).splitlines())
    return next((value.strip() for key, _, value in lines if key.strip() == name), "")
