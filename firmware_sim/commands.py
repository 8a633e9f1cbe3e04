"""The commands of `firmware-sim`: simulated machines behind real wires."""

import sys
import time
from pathlib import Path
from tempfile import mkdtemp
from threading import Event
from typing import Annotated

import typer

from firmware_sim.can_node import MISHAPS, mishap
from firmware_sim.draw_command import draw_command
from firmware_sim.jack_client import JackClient
from firmware_sim.laboratory import Laboratory, Wiring, plant_block
from firmware_sim.plants.milling_disturbance import DEFLECTIONS
from firmware_sim.population.signal_config import SignalConfig
from firmware_sim.relay import Relay, adapter_in, listen
from firmware_sim.robot_bench import MISHAPS as ROBOT_MISHAPS
from firmware_sim.robot_bench import (
    Addresses,
    RobotBench,
    cell_controller,
    cell_cut,
    cell_force_box,
    cell_wood,
    robot_mishap,
)
from firmware_sim.stage_bench import StageBench
from firmware_sim.stage_image import StageImage
from firmware_sim.stage_processor import Settings
from rigkit.command import ConfigOption, SetOption, application, laid_over
from rigkit.config import Section, load
from rigkit.relay.frame import IDENTIFIER
from rigkit.stop import SIGNALS, on_signals
from rigkit.written import written_file
from stagectl.config import StageConfig
from stagectl.robot.config import CellConfig
from vibractl.config import RigConfig
from vibractl.foreign.play_command import play_command

app = application("Simulated machines behind real wires, and from WAV to WAV.")
app.command("play")(play_command)
MODELS: dict[str, type[Section]] = {
    "vibrator": RigConfig,
    "stage": StageConfig,
    "pair": CellConfig,
    "cell": CellConfig,
    "signal": SignalConfig,
}
app.command("draw")(draw_command(MODELS))


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
    rig = load(config, RigConfig, laid_over(settings, {"simulator.options.seed": seed}))
    wiring = Wiring.of(rig.audio)
    laboratory = Laboratory(plant_block(rig.simulator.plant, rig.simulator.options), wiring)
    client = JackClient(laboratory, rig.audio.rate, name)
    with on_signals(dict.fromkeys(SIGNALS, client.end)):
        client.run(
            lambda: _say(f"{name} is ready: {wiring.outputs} in, {wiring.inputs} out, {rig.audio.rate} samples/s")
        )


@app.command()
def stage(
    pty: Annotated[bool, typer.Option("--pty", help="Behind pseudo-terminals.")] = False,
    config: ConfigOption = None,
    settings: SetOption = None,
    folder: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Where the two devices appear, as can and laser.")
    ] = None,
    milling: Annotated[str, typer.Option(help="x, y or z: a cut begins after a second.")] = "",
    laser_axis: Annotated[str, typer.Option(help="The axis that the laser sensor looks along.")] = "x",
    fault: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME@SECONDS", help=f"One of {', '.join(MISHAPS)}; may be given many times."),
    ] = None,
) -> None:
    """Put the stage's processor behind a CAN adapter and the laser sensor behind a serial line, until Ctrl-C.

    The rig file is the stage's own; [simulator] has the plant's options.  Example:

        firmware-sim stage --pty --folder /tmp/bench --fault unplug@5 --fault replug@8 &

        stagectl run --live --set link.channel=/tmp/bench/can ...
    """
    if not pty:
        raise ValueError("no wire is chosen, must be --pty")
    rig = load(config, StageConfig, settings or [])
    if laser_axis not in rig.stage.axes or milling not in ("", *DEFLECTIONS):
        raise ValueError(
            f"--laser-axis is {laser_axis!r}, must be {', '.join(rig.stage.axes)}; "
            f"--milling is {milling!r}, must be {', '.join(DEFLECTIONS)} or nothing"
        )
    image, mishaps = StageImage(rig, milling), [mishap(text) for text in fault or []]
    place = folder or Path(mkdtemp(prefix="stage-"))
    place.mkdir(parents=True, exist_ok=True)
    bench = StageBench(
        place,
        image,
        Settings(form=rig.link.form, silence=rig.link.silence, hold=rig.link.hold, ramp=rig.limits.ramp),
        rig.laser,
        rig.stage.axes.index(laser_axis),
        mishaps,
    )
    stop = Event()
    with on_signals(dict.fromkeys(SIGNALS, stop.set)):
        bench.run(lambda: _say(f"CAN adapter: {bench.can}\nlaser sensor: {bench.laser}"), stop)


@app.command()
def robot(
    config: ConfigOption = None,
    settings: SetOption = None,
    mill: Annotated[
        bool, typer.Option("--mill", help="The tool is over a block that it mills, as [pocket] says.")
    ] = False,
    wood: Annotated[
        bool, typer.Option("--wood", help="The tool is over a piece of oak that it mills, as [segments] says.")
    ] = False,
    log: Annotated[Path | None, written_file("FILE", "Write the motor torques to this CSV file.")] = None,
    fault: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME@SECONDS", help=f"One of {', '.join(ROBOT_MISHAPS)}; may be given many times."),
    ] = None,
) -> None:
    """Put a robot's controller behind UDP and TCP, and tracker and force sensor beside it, until Ctrl-C.

    With --mill a fresh block stands where [pocket] says: its top's middle where pocket.home has the tool; with --wood a
    piece of oak as [segments] says.  The robot's program puts another one there when it is told BLOCK 1, and takes it
    away by BLOCK 0.

    The file is the cell's, cell.toml: [robot], [tracker] and [force_sensor] have the ports, [simulator] the robot's
    options, plants.force_sensor_options the sensor's.
    Example:

        firmware-sim robot --set simulator.options.seed=3 --fault blind@5 --fault see@6 &
    """
    cell = load(config, CellConfig, settings or [])
    addresses = Addresses(
        cell.robot.listen, cell.robot.port, cell.robot.commands, cell.robot.signals, cell.tracker.port
    )
    mishaps = [robot_mishap(text) for text in fault or []]
    if mill and wood:
        raise ValueError("--mill and --wood are given, must be one of them")
    block = cell_cut if mill else cell_wood if wood else None
    controller, force = cell_controller(cell, block), cell_force_box(cell)
    bench = RobotBench(controller, addresses, cell.tracker.rate, mishaps=mishaps, log=log, force=force)
    stop = Event()
    lines = {
        "reports to": (addresses.host, addresses.motion),
        "program": bench.program.address,
        "torque signals": bench.signals.address,
        "tracker": bench.tracker.address,
        "force sensor": force.address,
    }
    with on_signals(dict.fromkeys(SIGNALS, stop.set)):
        bench.run(lambda: _say("\n".join(f"{name}: {host}:{port}" for name, (host, port) in lines.items())), stop)


@app.command()
def relay(
    pty: Annotated[bool, typer.Option("--pty", help="Behind a pseudo-terminal.")] = False,
    folder: Annotated[Path | None, typer.Option(metavar="DIR", help="Where the adapter appears, as can.")] = None,
    identifier: Annotated[int, typer.Option(min=0, max=0x7FF, help="Of the frames that count.")] = IDENTIFIER,
    patience: Annotated[float, typer.Option(min=0.03, max=10, metavar="SECONDS", help="Without one it opens.")] = 0.2,
) -> None:
    """Put the relay of an amplifier's supply behind a CAN adapter, until Ctrl-C; it says when it closes and opens.

    Example:

        firmware-sim relay --pty --folder /tmp/relay &

        vibractl run --set audio.relay.bus=can:Bus --set audio.relay.options.interface=slcan --set
        audio.relay.channel=/tmp/relay/can ...
    """
    if not pty:
        raise ValueError("no wire is chosen, must be --pty")
    adapter, stop = adapter_in(folder or Path(mkdtemp(prefix="relay-"))), Event()
    start = time.monotonic()

    def tell(closed: bool) -> None:
        _say(f"{time.monotonic() - start:8.3f} s: {'closed' if closed else 'open'}")

    with on_signals(dict.fromkeys(SIGNALS, stop.set)):
        _say(f"CAN adapter: {adapter.path}")
        listen(adapter, Relay(identifier, patience), time.monotonic, tell, stop)


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()
