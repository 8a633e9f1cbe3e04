"""The command `vibractl judge`."""

from pathlib import Path
from typing import Annotated, Any

import typer

from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, laid_over, print_table, words, write_json
from rigkit.figure_style import styled
from rigkit.written import made_folder, written_file
from vibractl.config import RigConfig
from vibractl.foreign.judge_report import judge_report
from vibractl.foreign.judged import Verdict, judged
from vibractl.foreign.signals import responses_of
from vibractl.foreign.tracks import open_mapped, parsed_map
from vibractl.judging import Judging
from vibractl.reference_option import ReferenceOption

HEAD = ("side", "worst bin, dB over", "at, Hz", "worst 50 Hz band, dB over", "IAE, m/s^2", "error, dB", "THD, dB")


def judge_command(
    recorded: Annotated[Path, typer.Argument(metavar="R.wav", help="The responses: WAV, FLAC or a table.")],
    reference: ReferenceOption = None,
    silence: Annotated[Path | None, typer.Option(metavar="S.wav", help="The same sensors without a drive.")] = None,
    config: ConfigOption = None,
    report: Annotated[Path | None, written_file("FILE", "Write an HTML page with the picture.")] = None,
    png: Annotated[Path | None, made_folder("DIR", "Write the picture as a PNG file.")] = None,
    channels: Annotated[
        str | None,
        typer.Option("--map", metavar="response_1=2,...", help="Channels by name or number; - inverts one."),
    ] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Judge one recording of any origin: whether the objective is met, by how much, and where it is worst.

    The reference is found in the recording, to a part of a sample.

    Example: `vibractl judge heard.wav --reference chirp:40:90:5 --report judged.html`
    """
    rig = rig_file.load(config, RigConfig, laid_over(settings, {"reference.signal": reference or None}))
    made, kind = Judging.of(rig), responses_of(rig.audio)
    given, rate = parsed_map(channels), rig.audio.rate
    quiet = None if silence is None else open_mapped(silence, kind, rate, given)
    found = judged(made, open_mapped(recorded, kind, rate, given), quiet)
    if report is not None or png is not None:
        with styled():
            page = judge_report(found, made, str(recorded))
            if report is not None:
                page.write(report)
            if png is not None:
                page.png(png)
    _print(found, made, str(recorded), json)
    write_json(json, figures(found, made))


def figures(found: Verdict, made: Judging) -> dict[str, Any]:
    """Return what other programs read of a verdict."""
    marks, side, silence = found.marks, found.worst_side, found.silence_db
    return {
        "met": marks.met,
        "margin_db": -float(marks.worst_line_db[side]),
        "worst_hz": float(marks.worst_line_hz[side]),
        "worst_response": marks.outputs[side] + 1,
        "responses": [output + 1 for output in marks.outputs],
        "margins_db": -marks.worst_line_db,
        "margins_hz": marks.worst_line_hz,
        "bands_db": -marks.worst_band_db,
        "bands_hz": marks.worst_band_hz,
        "overtones_db": marks.overtone_db.T,
        "thd_db": marks.thd_db,
        "iae": marks.iae,
        "error_db": marks.error_db,
        "begins_s": found.found.delay / made.shot.rate,
        "likeness": found.found.likeness,
        "inverted": [bool(gain < 0) for gain in found.found.gain],
        "silence_margin_db": None if silence is None else -silence,
        "worst_is_silence": found.is_noise,
    }


def _print(found: Verdict, made: Judging, name: str, json: str | None) -> None:
    marks, stream = found.marks, words(json)
    rows = [
        [
            f"response {output + 1}", f"{marks.worst_line_db[n]:+.1f}", f"{marks.worst_line_hz[n]:.1f}",
            f"{marks.worst_band_db[n]:+.1f} at {marks.worst_band_hz[n]:.0f} Hz", f"{marks.iae[n]:.4g}",
            f"{marks.error_db[n]:.1f}", f"{marks.thd_db[n]:.1f}",
        ]
        for n, output in enumerate(marks.outputs)
    ]  # fmt: skip
    print_table(f"{name}: against {made.config.reference.signal}, negative is good", HEAD, rows, stream)
    overtones = marks.overtone_db.T
    orders = [str(order) for order in range(2, 2 + overtones.shape[1])]
    body = [
        [f"response {output + 1}", *(f"{level:.1f}" for level in levels)]
        for output, levels in zip(marks.outputs, overtones, strict=True)
    ]
    print_table("overtones re the root, dB", ["side", *orders], body, stream)
    begins, fit = found.found.delay / made.shot.rate, found.found.likeness.min()
    stream.write(f"the reference begins at {begins:.6f} s, correlation {fit:.4f}\n")
    for n, output in enumerate(marks.outputs):
        if found.found.gain[n] < 0:
            stream.write(f"response {output + 1} is inverted: its correlation with the reference is negative\n")
    if found.silence_db is not None:
        told = ", ".join(f"{level:+.1f} dB" for level in found.silence_db)
        stream.write(f"silence, worst bin over the limit: {told}\n")
    if found.is_noise:
        stream.write("the worst bin is as loud in silence: it is hum or noise, and not emitted\n")
    stream.write(f"objective {marks.reason}\n")
