"""The command `firmware-sim play`: the simulated vibrator as a program from WAV to WAV."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from rigkit import config as rig_file
from rigkit.code_name import refuse_absent
from rigkit.command import ConfigOption, JsonOption, SetOption, laid_over, words, write_json
from rigkit.written import written_file
from vibractl.audio import Line
from vibractl.config import RigConfig
from vibractl.foreign.played_before import PlayedBefore
from vibractl.foreign.signals import drives_of, read_kind
from vibractl.foreign.sound_file import BITS, refuse_bits, write_sound

STREAM = "firmware_sim.audio:Stream"
SIMULATED = (f"audio.stream={STREAM}", "audio.isolated=false", "audio.device=''", "simulator.speed=0.0")
"""Laid over every rig file: nothing but the simulated card is played on."""


def play_command(
    drive: Annotated[Path, typer.Argument(metavar="DRIVE.wav", help="The drive, in parts of full scale.")],
    out: Annotated[Path, written_file("RESPONSE.wav", "The response, sample by sample.")],
    config: ConfigOption = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of the vibrator: simulator.options.seed.")] = None,
    plant: Annotated[str | None, typer.Option(help="Plant: simulator.plant.")] = None,
    state: Annotated[
        Path | None, typer.Option(metavar="FILE", help="State of the vibrator before and after; default: at rest.")
    ] = None,
    bits: Annotated[int, typer.Option(help=f"Of a sample: {', '.join(map(str, BITS))}; 32 and 64 are floats.")] = 64,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Play a WAV on the simulated vibrator and write its response as a WAV, as an audio interface records it.

    It goes through the program's own guard and alignment.  With --state a call continues where the last one ended,
    like the shots of one run: the file stores the earlier drives, which are played again first.

    Example: `firmware-sim play next.wav --out heard.wav --seed 3 --state vibrator.h5`
    """
    refuse_bits(bits)
    flags = {"simulator.options.seed": seed, "simulator.plant": plant}
    rig = rig_file.load(config, RigConfig, [*laid_over(settings, flags), *SIMULATED])
    refuse_absent(STREAM)
    wanted = read_kind(drive, drives_of(rig.audio), rig.audio.rate).astype(np.float32)
    before = PlayedBefore(_machine(rig)) if state is None else PlayedBefore.read(state, _machine(rig))
    after = before.after(wanted)
    longest = max(len(each) for each in after.drives) / rig.audio.rate
    with Line(rig, seconds=longest + 1.0) as line:
        for each in after.drives:
            capture = line.emit(each.astype(float))
    write_sound(out, capture.response.astype(float) / rig.audio.input_full_scale, rig.audio.rate, bits)
    if state is not None:
        after.write(state)
    loudest = float(np.abs(capture.response).max())
    seconds = len(wanted) / rig.audio.rate
    words(json).write(f"{out}: {seconds:.3g} s, at most {loudest:.3g} m/s^2\n")
    write_json(json, {"file": str(out), "seconds": seconds, "largest": loudest})


def _machine(rig: RigConfig) -> dict[str, Any]:
    """Return what must be the same for a vibrator to be the same, by key."""
    told = rig.model_dump(mode="json")
    audio = {f"audio.{key}": value for key, value in told["audio"].items() if key != "attempts"}
    limits = {f"limits.{key}": value for key, value in told["limits"].items()}
    return audio | limits | {f"simulator.{key}": value for key, value in told["simulator"].items()}
