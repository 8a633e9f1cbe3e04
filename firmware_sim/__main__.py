"""The command line `firmware-sim`."""

import sys


def main() -> int:
    """Run the command line and return its exit status."""
    try:
        # Here and not above: each process that the program starts imports this file anew, as the audio's does.
        from firmware_sim.application import PROGRAM

        return PROGRAM.run()
    except KeyboardInterrupt:  # while it imports; later on a command sees to it
        return 130


if __name__ == "__main__":
    sys.exit(main())
