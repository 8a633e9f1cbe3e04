"""The command `stagectl daemon`."""

from rigkit.service.daemon_command import daemon_of
from stagectl.daemon.kinds import kind_of

daemon_command = daemon_of(kind_of)
