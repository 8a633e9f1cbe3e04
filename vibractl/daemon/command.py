"""The command `vibractl daemon`."""

from rigkit.service.daemon_command import Kind, daemon_of
from vibractl.config import RigConfig

KIND = Kind(RigConfig, "vibractl.daemon.rig:Vibrator")

daemon_command = daemon_of(lambda *_: KIND)
