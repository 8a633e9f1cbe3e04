"""What is asked for of an import, and all that is found out before anything is written."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ctlblocks.recording import RecordingError
from rigkit.foreign_stream import Signals
from rigkit.progress import progress
from vibractl.config import RigConfig
from vibractl.foreign.import_plan import Scanned, scan
from vibractl.foreign.import_verdict import Remark, refuse_other_clock, refuse_unrelated, remarks, spoiled
from vibractl.foreign.importing import Import, correction_of
from vibractl.foreign.recorded import Scales, open_recorded, paired
from vibractl.foreign.signals import Kind, responses_of
from vibractl.foreign.tracks import open_track
from vibractl.judging import Judging
from vibractl.model_origin import model_for
from vibractl.setup import Setup, setup
from vibractl.transfer_matrix import TransferMatrix


@dataclass(frozen=True)
class Request:
    """What is asked for.

    Parameters
    ----------
    rig : RigConfig
    drive, response : str
        Files, or patterns.
    model, silence : Path or None
    channels : mapping of str to str
        As of `parsed_map`.
    scales : Scales
    delay : float or None, samples
        By which responses come late, where a person knows it.
    correct_clock, skip_spoiled : bool
    accept : collection of str
        Keys in which the rig that the model was measured on may differ.
    """

    rig: RigConfig
    drive: str
    response: str
    model: Path | None
    silence: Path | None
    channels: Mapping[str, str]
    scales: Scales
    delay: float | None
    correct_clock: bool
    skip_spoiled: bool
    accept: Collection[str]


def examined(asked: Request) -> Import:
    """Find and examine all shots.

    Parameters
    ----------
    asked : Request

    Raises
    ------
    ValueError : no run can be made of it; it says why in one line, and nothing is written.
    """
    made, matrix, notes = _made(asked)
    quiet = None if asked.silence is None else _silence(asked.silence, made, asked)
    pairs = paired(asked.drive, asked.response)
    recordings = [open_recorded(*pair, asked.rig, made.shot, asked.scales, asked.channels) for pair in pairs]
    total = sum(each.frames for each in recordings)
    with progress("examining", total) as meter:
        scanned = scan(recordings, made, matrix, asked.delay, lambda done: meter.show(min(done, total - 1)))
        refuse_unrelated(scanned, made)
        if not asked.correct_clock:
            refuse_other_clock(scanned, made)
        kept, left_out = _whole(scanned, made, asked.skip_spoiled)
        meter.show(total)
    said = [Remark(note) for note in notes] + list(remarks(kept, made))
    if asked.correct_clock:
        said = [*(each for each in said if "--correct-clock" not in each.text), *_corrections(kept)]
    return Import(kept, made, asked.model, said, left_out, quiet, asked.accept, asked.correct_clock)


def _made(asked: Request) -> tuple[Setup | Judging, TransferMatrix | None, list[str]]:
    """Return what shots are judged by, the model, and what is to be said of it."""
    hydrophones = list(asked.rig.audio.far_field_channels)
    if hydrophones:
        raise ValueError(
            f"audio.far_field_channels is {hydrophones}, must be []: drives and accelerometers are imported, no "
            "hydrophones; --set audio.far_field_channels=[]"
        )
    if asked.model is None:
        return Judging.of(asked.rig), None, []
    matrix, notes = model_for(asked.model, asked.rig, asked.accept)
    return setup(asked.rig, matrix), matrix, notes


def _silence(path: Path, made: Setup | Judging, asked: Request) -> Signals:
    audio = made.config.audio
    kind = Kind("response", responses_of(audio).width, "m/s^2", asked.scales.acceleration)
    try:
        track = open_track(path, [kind], audio.rate, {})
    except RecordingError:  # as many channels as the recordings have
        track = open_track(path, [kind], audio.rate, asked.channels)
    if track.frames < made.shot.total:
        raise RecordingError(f"{path}: {track.frames} samples, must be at least {made.shot.total}, a shot's")
    return track.signals.scaled(kind.unit, track.scale)


def _whole(scanned: Sequence[Scanned], made: Setup | Judging, skip: bool) -> tuple[list[Scanned], dict[int, str]]:
    """Return recordings with the shots that are a measurement, and why others are left out."""
    wrong = {number: reason for each in scanned for number, reason in spoiled(each, made).items()}
    if wrong and not skip:
        first = next(iter(wrong.values()))
        raise RecordingError(f"{first}; --skip-spoiled leaves out such shots, {len(wrong)} of them")
    kept = [replace(each, shots=tuple(shot for shot in each.shots if shot.number not in wrong)) for each in scanned]
    kept = [each for each in kept if each.shots]
    if not kept:
        raise RecordingError(f"{next(iter(wrong.values()))}; no shot is left, must be at least 1")
    return kept, wrong


def _corrections(scanned: Sequence[Scanned]) -> list[Remark]:
    """Say what is taken out of the clocks."""
    said = []
    for each in scanned:
        taken = correction_of(each)
        what = f"{taken.text} ppm" if taken.value else "not determinable"
        said.append(Remark(f"{each.recorded.name}: taken out of the clock: {what}; responses are resampled"))
    return said
