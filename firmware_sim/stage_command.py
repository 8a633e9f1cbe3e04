"""The command `firmware-sim stage`: the stage's processor behind its wire."""

from pathlib import Path
from tempfile import mkdtemp
from threading import Event
from typing import Annotated

import typer

from firmware_sim.can_node import MISHAPS, mishap
from firmware_sim.plants.milling_disturbance import DEFLECTIONS
from firmware_sim.ready import be_ready
from firmware_sim.stage_bench import StageBench
from firmware_sim.stage_image import StageImage
from firmware_sim.stage_processor import Settings
from rigkit.command import ConfigOption, JsonOption, SetOption
from rigkit.config import load
from rigkit.stop import SIGNALS, on_signals
from stagectl.config import StageConfig


def stage_command(
    pty: Annotated[bool, typer.Option("--pty", help="Use pseudo-terminals.")] = False,
    config: ConfigOption = None,
    settings: SetOption = None,
    folder: Annotated[Path | None, typer.Option(metavar="DIR", help="Folder of the adapter, can.")] = None,
    milling: Annotated[str, typer.Option(help="x, y or z: a cut begins with each live run that is judged.")] = "",
    fault: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME@SECONDS", help=f"One of {', '.join(MISHAPS)}; may be repeated."),
    ] = None,
    json: JsonOption = None,
) -> None:
    """Put the stage's processor behind a CAN adapter, until Ctrl-C.

    The rig file is the stage's own; [simulator] has the plant's options.  Example:

        firmware-sim stage --pty --folder /tmp/bench --fault unplug@5 --fault replug@8 &

        stagectl run --live --set link.channel=/tmp/bench/can ...
    """
    if not pty:
        raise ValueError("no wire is chosen, must be --pty")
    rig = load(config, StageConfig, settings or [])
    if milling not in ("", *DEFLECTIONS):
        raise ValueError(f"--milling is {milling!r}, must be {', '.join(DEFLECTIONS)} or nothing")
    image, mishaps = StageImage(rig, milling), [mishap(text) for text in fault or []]
    place = folder or Path(mkdtemp(prefix="stage-"))
    place.mkdir(parents=True, exist_ok=True)
    bench = StageBench(
        place,
        image,
        Settings(form=rig.link.form, silence=rig.link.silence, hold=rig.link.hold, ramp=rig.limits.ramp),
        mishaps,
    )
    stop = Event()
    with on_signals(dict.fromkeys(SIGNALS, stop.set)):
        bench.run(lambda: _say_ready(bench, json), stop)


def _say_ready(bench: StageBench, json: str | None) -> None:
    be_ready(f"CAN adapter: {bench.can}", {"can": str(bench.can)}, json)
