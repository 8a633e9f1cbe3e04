"""The command line `stagectl`."""

import sys

from rigkit.service.command import run_application
from stagectl.application import app


def main() -> int:
    """Run the command line and return its exit status."""
    return run_application(app, "stagectl.commands", "stagectl", "firmware_sim")


if __name__ == "__main__":
    sys.exit(main())
