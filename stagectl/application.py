"""The command line `stagectl`: what it has at once, `daemon`, `status` and `stop`."""

from rigkit.command import application
from rigkit.service.command import add_daemon_commands
from stagectl.daemon.kinds import kind_of

app = application("The piezo stage follows its reference, and takes back what pushes it away.")
add_daemon_commands(app, kind_of)
