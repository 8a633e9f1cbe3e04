"""Serve the demonstration, to look at its page: `python -m tests.rigkit.service.serve_demo FOLDER [SETTINGS [FILE]]`.

SETTINGS are those of the table `[daemon]`, as JSON; FILE is the rig file that they are of.
"""

import json
import sys
from pathlib import Path

from rigkit.service.config import Daemon
from rigkit.service.daemon import run
from tests.rigkit.service.demo_rig import DemoRig

if __name__ == "__main__":
    folder, *more = sys.argv[1:]
    settings = Daemon.model_validate_json(json.dumps({"data": folder} | (json.loads(more[0]) if more else {})))
    sys.stderr.write(f"tokens: {Path(folder) / 'token'}\n")
    run(
        DemoRig(settings.faults),
        settings,
        lambda text: sys.stderr.write(f"{text}\n"),
        Path(more[1]) if more[1:] else None,
    )
