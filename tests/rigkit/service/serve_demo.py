"""Serve the demonstration: `python -m tests.rigkit.service.serve_demo FOLDER [ADDRESS]`, for looking at the page."""

import sys
from pathlib import Path

from rigkit.service.config import Daemon
from rigkit.service.daemon import run
from tests.rigkit.service.demo_rig import DemoRig

if __name__ == "__main__":
    address = sys.argv[2] if len(sys.argv) > 2 else "127.0.0.1:8787"
    settings = Daemon(data=sys.argv[1], address=address)
    sys.stderr.write(f"tokens: {Path(sys.argv[1]) / 'token'}\n")
    run(DemoRig(), settings, lambda text: sys.stderr.write(f"{text}\n"))
