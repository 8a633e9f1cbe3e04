"""What a page says of the machine that it was made on."""

import os
import platform
from pathlib import Path


def machine() -> str:
    """Return the number of processors and their maker's name for them, and the load average over a minute."""
    return f"{os.cpu_count()} processors ({processor()}), load average {os.getloadavg()[0]:.1f}"


def processor() -> str:
    """Return its maker's name for it, where the system knows."""
    known = Path("/proc/cpuinfo")
    lines = known.read_text(encoding="utf-8").splitlines() if known.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
