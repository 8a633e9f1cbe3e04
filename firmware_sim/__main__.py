"""The `firmware-sim` command: simulated machines behind real wires."""

import signal
import sys
from types import FrameType
from typing import Annotated

import typer

from firmware_sim.jack_client import JackClient
from firmware_sim.laboratory import Laboratory, Wiring, plant_block
from rigkit.command import ConfigOption, SetOption, application, run
from rigkit.config import load
from vibractl.config import RigConfig

app = application("Simulated machines behind real wires.")


@app.command()
def vibrator(
    jack: Annotated[bool, typer.Option("--jack", help="Behind a JACK audio server, which must be running.")] = False,
    config: ConfigOption = None,
    settings: SetOption = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Which vibrator: simulator.options.seed.")] = None,
    name: Annotated[str, typer.Option(help="The JACK client's name, which PortAudio lists as a device.")] = "shaker",
) -> None:
    """Put the marine vibrator behind a JACK audio server, wired as the rig file says, until Ctrl-C.

    Its inputs in_1, in_2, ... are the card's output channels (drives and loopback), its outputs out_1, out_2, ... the
    card's input channels.  Example:

        jackd -d dummy -r 44100 -p 512 &

        firmware-sim vibrator --jack --seed 3 &

        vibractl run --set audio.stream=sounddevice:Stream --set audio.device=shaker ...
    """
    if not jack:
        raise ValueError("no wire is chosen, must be --jack")
    overrides = [*(settings or []), *([] if seed is None else [f"simulator.options.seed={seed}"])]
    rig = load(config, RigConfig, overrides)
    wiring = Wiring.of(rig.audio)
    laboratory = Laboratory(plant_block(rig.simulator.plant, rig.simulator.options), wiring)
    client = JackClient(laboratory, rig.audio.rate, name)

    def end(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 (signal's own argument list)
        client.end()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, end)
    client.run(lambda: _say(f"{name} is ready: {wiring.outputs} in, {wiring.inputs} out, {rig.audio.rate} samples/s"))


def main() -> int:
    """Run the command line and return its exit status."""
    return run(app, "firmware_sim")


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
