"""The command `vibractl step`."""

import hashlib
import sys
from collections.abc import Collection
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import numpy as np
import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption, agreed, changed_parts, differences
from rigkit.command import ConfigOption, JsonOption, SetOption, laid_over, words, write_json
from rigkit.origin import Origin
from rigkit.written import written_file
from vibractl.config import Audio, RigConfig
from vibractl.foreign.sound_file import BITS, refuse_bits, write_sound
from vibractl.foreign.step_state import StepState
from vibractl.foreign.stepping import Stepped, Stepper
from vibractl.loudness import FitOption
from vibractl.reference import is_file
from vibractl.reference_option import ReferenceOption
from vibractl.run_setup import MODEL, UNCHANGED, create, settings_of, setup_of

WAY_OUT = "go back to what it began with, or begin again with another --state"


def step_command(
    state: Annotated[Path, typer.Option(metavar="S.h5", help="State of the learning; created by the first call.")],
    out: Annotated[Path, written_file("NEXT.wav", "The drive to play next, in parts of full scale.")],
    drive: Annotated[Path | None, typer.Option(metavar="D.wav", help="The drive that was played.")] = None,
    response: Annotated[Path | None, typer.Option(metavar="R.wav", help="The response that was recorded.")] = None,
    model: Annotated[Path | None, typer.Option(metavar="FILE", help="Model file from `calibrate vibrator`.")] = None,
    config: ConfigOption = None,
    reference: ReferenceOption = None,
    fit_amplitude: FitOption = False,
    bits: Annotated[int, typer.Option(help=f"Of a sample: {', '.join(map(str, BITS))}; 32 and 64 are floats.")] = 64,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Compute one iteration of the learning for drives that other software plays: the first drive, or the next one.

    The first call takes the model and the reference and writes the first drive.  Each further call takes what was
    played and what came back, and writes the next drive; the same recording twice is refused.  Without a recording it
    writes the present drive again.

    Example: `vibractl step --model model.h5 --reference chirp:40:90:5 --state S.h5 --out 0.wav`, then
    `vibractl step --drive 0.wav --response heard.wav --state S.h5 --out 1.wav`
    """
    _refuse_half(drive, response)
    refuse_bits(bits)
    over = laid_over(settings, {"reference.signal": reference or None})
    is_new = not state.exists()
    if is_new:
        if model is None or drive is not None:
            raise ValueError(
                f"{state}: there is no such state yet; begin with --model FILE and --reference, without --drive"
            )
        begun = _begun(rig_file.load(config, RigConfig, over), model, accept or [], fit_amplitude)
    else:
        _refuse_fit(fit_amplitude, state)
        begun = StepState.read(state)
        whole = rig_file.load(config, RigConfig, over) if config is not None or settings else None
        _refuse_changed(begun, state, whole, reference, model, accept or [])
    with begun.folder() as place:
        made = setup_of(place)
        stepper = Stepper(begun, made)
        taken = None if drive is None or response is None else stepper.take(drive, response)
        wanted, audio = stepper.drive, made.config.audio
    write_sound(out, wanted / audio.output_full_scale, audio.rate, bits)
    if taken is not None or is_new:
        stepper.state.write(state)
    _tell(out, taken, len(stepper.state.steps), wanted, audio, json)


def _refuse_fit(fit_amplitude: bool, state: Path) -> None:
    if fit_amplitude:
        raise ValueError(f"--fit-amplitude is given, and {state} has begun: its reference cannot change")


def _refuse_half(drive: Path | None, response: Path | None) -> None:
    if (drive is None) != (response is None):
        raise ValueError("--drive and --response go together: what was played, and what came back")


def _tell(out: Path, taken: Stepped | None, shot: int, wanted: np.ndarray, audio: Audio, json: str | None) -> None:
    """Say what came of the shot that was taken, and which drive is written."""
    stream, figures = words(json), {"shot": shot, "drive": str(out), "samples": len(wanted), "rate": audio.rate}
    if taken is not None:
        found = dict(taken.state.steps[-1].marks)
        stream.write(f"shot {taken.shot}: objective {found['reason']}\n")
        figures |= {"taken": found}
    seconds, volts = len(wanted) / audio.rate, audio.output_full_scale
    stream.write(f"{out}: the drive of shot {shot}, {seconds:.3g} s; 1 is {volts:g} V\n")
    write_json(json, figures)


def _begun(config: RigConfig, model: Path, accept: Collection[str], fit_amplitude: bool) -> StepState:
    """Check everything that a learning needs, and put it together."""
    with TemporaryDirectory(prefix="vibractl-step-") as place:
        folder, made = create(Path(place) / "run", config, model, shots=1, accept=accept, fit_amplitude=fit_amplitude)
        with folder:
            sys.stderr.write("".join(f"{note}\n" for note in (*made.said, made.note) if note))
            return StepState.of_folder(folder.path)


def _refuse_changed(
    begun: StepState,
    state: Path,
    whole: RigConfig | None,
    reference: str | None,
    model: Path | None,
    accept: Collection[str],
) -> None:
    """Refuse settings, a reference or a model that are given and are others than it began with."""
    with begun.folder() as place:
        kept = settings_of(place)
    found = []
    if whole is not None:
        if whole.spectrum.backend == "auto":
            whole = whole.model_copy(update={"spectrum": kept.spectrum})
        found += differences(kept.model_dump(mode="json"), whole, UNCHANGED)
    elif reference is not None and not is_file(reference):
        told = kept.model_dump(mode="json")
        given = kept.model_copy(update={"reference": kept.reference.model_copy(update={"signal": reference})})
        found += differences(told, given, UNCHANGED)
    parts = {MODEL: model} if model is not None else {}
    if reference is not None and is_file(reference):
        parts[Path(kept.reference.signal).name] = Path(reference)
    then = {name: hashlib.sha256(begun.parts.get(name, b"")).hexdigest() for name in parts}
    now = {name: hashlib.sha256(path.read_bytes()).hexdigest() for name, path in parts.items()}
    found += changed_parts(Origin("vibrator run", {}, then), now)
    for note in agreed(found, accept, f"{state} began otherwise", WAY_OUT):
        sys.stderr.write(f"{note}\n")
