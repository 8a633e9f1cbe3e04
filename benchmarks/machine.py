"""What a page says of the machine that it was made on."""

import os

from rigkit.machine_facts import processor


def machine() -> str:
    """Return the number of processors and their maker's name for them, and the load average over a minute."""
    return f"{os.cpu_count()} processors ({processor()}), load average {os.getloadavg()[0]:.1f}"
