"""A command line that ends in every way there is, for the tests: `python -m tests.rigkit.command_line KIND`."""

import sys

import numpy as np

from rigkit import command
from rigkit.config import load
from rigkit.stop import Stopped, stoppable
from tests.rigkit.rig_file import RigFile

app = command.application("Ends in every way there is.")


@app.command()
def show(
    config: command.ConfigOption = None, settings: command.SetOption = None, json: command.JsonOption = None
) -> None:
    """Show a setting [of the device].

    Example: show --set device.rate=48000
    """
    device = load(config, RigFile, settings or ()).device
    command.write_json(json, {"rate": device.rate, "gain": np.float64(device.gain), "worst": np.nan})
    command.print_table("Device [1]", ["key", "value [V]"], [["gain [bold]", f"{device.gain}"]], command.words(json))


@app.command()
def end(kind: str) -> None:
    """End in a way of your choice."""
    if kind == "value":
        raise ValueError("audio.rate is 3,\n must be 4")
    if kind == "key":
        raise KeyError("no block 'guard'")
    if kind == "file":
        open("/nowhere/rig.toml").close()
    if kind == "within a file":
        open(f"{__file__}/run/config.toml").close()
    if kind == "full":
        raise OSError(28, "No space left on device")
    if kind == "device":
        raise OSError("no device 'card'; there are shaker")
    if kind == "numpy":
        np.ones(3) + np.ones(4)
    if kind == "slip":
        {}["absent"]
    if kind == "program":
        raise RuntimeError("cannot be")
    if kind == "stopped":
        raise Stopped("stopped after shot 3; run --resume RUN/ goes on")


@app.command()
def wait() -> None:
    """Wait for the signal to stop."""
    with stoppable() as request:
        sys.stdout.write("waiting\n")
        sys.stdout.flush()
        while not request.made:
            pass
    raise Stopped("stopped")


if __name__ == "__main__":
    sys.exit(command.run(app, "tests"))
