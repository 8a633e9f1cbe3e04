"""The command `firmware-sim robot`: a robot's controller, tracker and force sensor behind their wires."""

from pathlib import Path
from threading import Event
from typing import Annotated

import typer

from firmware_sim.plate_file import seen_plate
from firmware_sim.ready import be_ready
from firmware_sim.robot_bench import MISHAPS, Addresses, RobotBench, robot_mishap
from firmware_sim.robot_cell import cell_controller, cell_cut, cell_force_box, cell_wood
from rigkit.command import ConfigOption, JsonOption, SetOption
from rigkit.config import load
from rigkit.stop import SIGNALS, on_signals
from rigkit.written import written_file
from stagectl.robot.config import CellConfig

FaultOption = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME@SECONDS", help=f"One of {', '.join(MISHAPS)}; may be repeated."),
]


def robot_command(
    config: ConfigOption = None,
    settings: SetOption = None,
    mill: Annotated[
        bool, typer.Option("--mill", help="The tool is over a block that it mills, as [pocket] says.")
    ] = False,
    wood: Annotated[
        bool, typer.Option("--wood", help="The tool is over a piece of oak that it mills, as [segments] says.")
    ] = False,
    plate: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="`plate` in the --folder of `firmware-sim stage`: the spindle is on it."),
    ] = None,
    log: Annotated[Path | None, written_file("FILE", "Write the motor torques to this CSV file.")] = None,
    fault: FaultOption = None,
    json: JsonOption = None,
) -> None:
    """Put a robot's controller behind UDP and TCP, and tracker and force sensor beside it, until Ctrl-C.

    With --mill a fresh block stands where [pocket] says: its top's middle where pocket.home has the tool; with --wood a
    piece of oak as [segments] says.  The robot's program puts another one there on BLOCK 1, and takes it
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
    seen = None if plate is None else seen_plate(plate)
    bench = RobotBench(controller, addresses, cell.tracker.rate, mishaps=mishaps, log=log, force=force, plate=seen)
    stop = Event()
    lines = {
        "reports to": (addresses.host, addresses.motion),
        "program": bench.program.address,
        "torque signals": bench.signals.address,
        "tracker": bench.tracker.address,
        "force sensor": force.address,
    }
    figures = {name.replace(" ", "_"): f"{host}:{port}" for name, (host, port) in lines.items()}
    text = "\n".join(f"{name}: {host}:{port}" for name, (host, port) in lines.items())
    with on_signals(dict.fromkeys(SIGNALS, stop.set)):
        bench.run(lambda: be_ready(text, figures, json), stop)
