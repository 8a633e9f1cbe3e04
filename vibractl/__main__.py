"""The command line `vibractl`."""

import sys

from rigkit.service.command import run_application
from vibractl.application import app


def main() -> int:
    """Run the command line and return its exit status."""
    return run_application(app, "vibractl.commands", "vibractl")


if __name__ == "__main__":
    sys.exit(main())
