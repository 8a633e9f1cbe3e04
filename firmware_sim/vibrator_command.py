"""The command `firmware-sim vibrator`: the marine vibrator behind an audio server."""

from typing import Annotated

import typer

from firmware_sim.jack_client import JackClient
from firmware_sim.laboratory import Laboratory, Wiring, plant_block
from firmware_sim.ready import be_ready
from rigkit.command import ConfigOption, JsonOption, SetOption, laid_over
from rigkit.config import load
from rigkit.stop import SIGNALS, on_signals
from vibractl.config import RigConfig


def vibrator_command(
    jack: Annotated[bool, typer.Option("--jack", help="Behind a JACK audio server, which must be running.")] = False,
    config: ConfigOption = None,
    settings: SetOption = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of the vibrator: simulator.options.seed.")] = None,
    name: Annotated[str, typer.Option(help="The JACK client's name, which PortAudio lists as a device.")] = "shaker",
    json: JsonOption = None,
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
    rig = load(config, RigConfig, laid_over(settings, {"simulator.options.seed": seed}))
    wiring = Wiring.of(rig.audio)
    laboratory = Laboratory(plant_block(rig.simulator.plant, rig.simulator.options), wiring)
    client = JackClient(laboratory, rig.audio.rate, name)
    figures = {"name": name, "inputs": wiring.outputs, "outputs": wiring.inputs, "rate": rig.audio.rate}
    text = f"{name} is ready: {wiring.outputs} in, {wiring.inputs} out, {rig.audio.rate} samples/s"
    with on_signals(dict.fromkeys(SIGNALS, client.end)):
        client.run(lambda: be_ready(text, figures, json))
