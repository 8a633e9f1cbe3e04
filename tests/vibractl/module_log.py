"""A plant that writes down which modules its process has imported, and is then of no use."""

import json
import sys
from pathlib import Path

from ctlblocks.block import Block, Port


class ModuleLog(Block):
    """Refuses to be opened.

    Ports: `drive` (V) in, `response` (m/s^2) out.
    """

    inputs = (Port("drive", "V", 2),)
    outputs = (Port("response", "m/s^2", 2),)

    def __init__(self, file: str) -> None:
        Path(file).write_text(json.dumps(sorted(sys.modules)))
        raise ValueError("the modules are written down")
