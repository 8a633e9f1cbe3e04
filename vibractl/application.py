"""The command line `vibractl`: what it has at once, `daemon`, `status` and `stop`."""

from rigkit.command import application
from rigkit.service.command import Kind, add_daemon_commands
from vibractl.config import RigConfig

KIND = Kind(RigConfig, "vibractl.daemon.rig:Vibrator")

app = application("The marine vibrator learns, shot by shot, to emit the reference and nothing else.")
add_daemon_commands(app, lambda *_: KIND)
