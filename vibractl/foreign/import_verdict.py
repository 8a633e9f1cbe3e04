"""What stands against an import, which is then refused, and what is said of it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ctlblocks.recording import RecordingError
from vibractl.foreign.estimate import CERTAIN
from vibractl.foreign.import_plan import FoundShot, Scanned
from vibractl.foreign.pair import LIKE
from vibractl.foreign.sample_faults import SampleFault
from vibractl.foreign.wiring import Exchange, Sign
from vibractl.judging import Judging
from vibractl.proof import SLIP
from vibractl.setup import Setup

UNRELATED = 0.3
"""Correlation of a response with a drive at any delay, or with what the model expects, below which nothing relates
them: a vibrator turns a sweep's phase while it goes by, but leaves 0.7 and more."""
BESIDE = 0.01
"""s around a dropout, in which the reference must be audible: else it is silence."""
AUDIBLE = 0.01
"""Of a reference's largest value."""


@dataclass(frozen=True)
class Remark:
    """Something that is said of an import, and kept with it.

    Parameters
    ----------
    text : str
    is_warning : bool
        Whether a person should look after it.
    """

    text: str
    is_warning: bool = True


def refuse_unrelated(scanned: Sequence[Scanned], made: Setup | Judging) -> None:
    """Refuse drives and responses that do not belong together, or are wired otherwise than is said.

    Parameters
    ----------
    scanned : sequence of Scanned
    made : Setup, or Judging without a model

    Raises
    ------
    RecordingError : it names the file, where in it, the value and what is allowed.
    """
    has_model = isinstance(made, Setup)
    for each in scanned:
        for shot in each.shots:
            where = f"{each.recorded.name}: at {shot.placed.response / made.shot.rate:.3f} s"
            _refuse_strange(where, shot, made)
            for kind, exchange in (("drive", shot.seen.drives), ("response", shot.seen.responses)):
                if exchange is not None and exchange.is_other and exchange.is_sure:
                    raise RecordingError(f"{where}: {_wired(kind, exchange)}; --map says which channel is which")
            inverted = [side for side, sign in _signs(shot, made) if sign.is_inverted and sign.is_sure]
            if inverted and has_model:
                raise RecordingError(
                    f"{where}: response {' and '.join(map(str, inverted))} inverted against what the model expects, "
                    f"must not be: --map response_{inverted[0]}=-CHANNEL turns it round"
                )


def refuse_other_clock(scanned: Sequence[Scanned], made: Setup | Judging) -> None:
    """Refuse recordings of which the recorder's clock is another than the player's.

    Raises
    ------
    RecordingError : it names the file, both clocks' difference and what is allowed.
    """
    for each in scanned:
        clock, a_ppm = each.clock, 1e-6 * made.shot.frames
        if clock is None or abs(clock.value) * a_ppm <= SLIP + CERTAIN * clock.error * a_ppm:
            continue
        raise RecordingError(
            f"{each.recorded.name}: was recorded by a clock that is {clock.text} ppm "
            f"faster than the player's: {abs(clock.value) * a_ppm:.2f} samples in a shot, must be <= {SLIP:g}; "
            "--correct-clock takes it out, or play and record by one device"
        )


def spoiled(scanned: Scanned, made: Setup | Judging) -> dict[int, str]:
    """Return the shots of a recording that are no measurement, by number, and why.

    Parameters
    ----------
    scanned : Scanned
    made : Setup, or Judging without a model
    """
    recorded, found = scanned.recorded, {}
    sides = [recorded.heard.start + side for side in made.places[0].sensors]
    for shot in scanned.shots:
        first, end = shot.placed.response, shot.placed.response + made.shot.sounded
        at = f"{recorded.name}: shot {shot.number} at {first / made.shot.rate:.3f} s"
        if first < 0 or end > recorded.frames:
            found[shot.number] = f"{at}: is cut off, its reference must lie within 0 to {recorded.frames} samples"
        faults = [each for each in scanned.faults if each.channel in sides and first < each.end and each.first < end]
        faults = [each for each in faults if each.kind == "clipped" or _is_amid(each, shot, made)]
        if faults and shot.number not in found:
            name = f"response {faults[0].channel - recorded.heard.start + 1}"
            found[shot.number] = f"{recorded.name}: {_told(faults[0], name, len(faults) - 1, made.shot.rate)}"
    return found


def remarks(scanned: Sequence[Scanned], made: Setup | Judging) -> Iterator[Remark]:
    """Say what a person should know of recordings that are imported.

    Parameters
    ----------
    scanned : sequence of Scanned
    made : Setup, or Judging without a model
    """
    shots = [shot for each in scanned for shot in each.shots]
    for each in scanned:
        yield from _of_files(each)
    yield from _of_ends(shots, made)
    yield from _of_raster(shots)
    yield from _of_wires(shots, made)
    yield from _of_delay(shots, made)
    if all(each.clock is None for each in scanned):
        text = (
            "whether player and recorder share one clock cannot be determined without a model or monitors of the drives"
        )
        yield Remark(text, is_warning=False)


def numbered(numbers: Sequence[int]) -> str:
    """Return numbers of shots in words.

    Parameters
    ----------
    numbers : sequence of int, rising

    Examples
    --------
    >>> numbered([4]), numbered([0, 1, 2, 3, 7])
    ('shot 4', 'shots 0-3, 7')
    """
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    told = ", ".join(f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs)
    return f"{'shots' if len(numbers) > 1 else 'shot'} {told}"


def _refuse_strange(where: str, shot: FoundShot, made: Setup | Judging) -> None:
    """Refuse a response that has nothing to do with its drive, or a drive that is another one."""
    sides = list(made.places[0].sensors)
    like = shot.seen.follows[sides]
    if np.all(like < UNRELATED):
        raise RecordingError(
            f"{where}: does not belong to {shot.recorded.drive.path}: correlation {like.max():.2f} of response and "
            f"drive at any delay within 0.5 s, must be >= {UNRELATED:g}"
        )
    if np.any(like < UNRELATED):
        side = sides[int(like.argmin())] + 1
        raise RecordingError(
            f"{where}: response {side} does not follow the drives: correlation {like.min():.2f} at any delay within "
            f"0.5 s, must be >= {UNRELATED:g}; a dead channel, or another sensor"
        )
    if shot.recorded.widths[2] and not shot.seen.likeness >= LIKE:
        raise RecordingError(
            f"{where}: the monitors do not hold the drive of {shot.recorded.drive.path}: correlation "
            f"{shot.seen.likeness:.3f}, must be >= {LIKE:g}"
        )


def _of_files(scanned: Scanned) -> Iterator[Remark]:
    recorded = scanned.recorded
    for track in dict.fromkeys((recorded.drive, recorded.response)):
        if not track.says_rate:
            yield Remark(f"{track.path}: says no rate, it is taken for the rig's, {track.signals.rate:g} samples/s")
    if recorded.is_beside:
        coils = [each for each in scanned.faults if each.channel < recorded.widths[0] and each.kind == "clipped"]
        if coils:
            name = f"drive {coils[0].channel + 1}"
            yield Remark(f"{recorded.drive.path}: {_told(coils[0], name, len(coils) - 1, recorded.drive.signals.rate)}")


def _of_ends(shots: Sequence[FoundShot], made: Setup | Judging) -> Iterator[Remark]:
    """Say what of shots is not recorded."""
    before = [max(made.shot.lead - shot.placed.response, 0) for shot in shots]
    ends = made.shot.frames + made.shot.tail
    behind = [max(shot.placed.response + ends - shot.recorded.frames, 0) for shot in shots]
    for missing, what in ((before, "before"), (behind, "behind")):
        some = [shot.number for shot, samples in zip(shots, missing, strict=True) if samples]
        if some:
            text = (
                f"{numbered(some)}: up to {max(missing) / made.shot.rate:.3g} s {what} the reference are not recorded"
            )
            yield Remark(f"{text}; silence is inserted there", is_warning=False)


def _of_raster(shots: Sequence[FoundShot]) -> Iterator[Remark]:
    """Say which shots lie between the samples of the first one."""
    known = [shot for shot in shots if shot.placed.is_exact]
    off = [shot.placed.fraction - known[0].placed.fraction for shot in known]
    some = [shot.number for shot, by in zip(known, off, strict=True) if not abs(by) <= SLIP]
    if some:
        yield Remark(
            f"{numbered(some)}: {max(map(abs, off)):.2f} samples at most off the raster of shot {known[0].number}, "
            f"should be within {SLIP:g}; --correct-clock moves them there"
        )


def _of_delay(shots: Sequence[FoundShot], made: Setup | Judging) -> Iterator[Remark]:
    """Say how late responses come, and what is done about it."""
    removed, delay = shots[0].placed.removed, shots[0].placed.delay
    if removed:
        yield Remark(f"responses are put {removed} samples earlier: by so much they come after the drives")
    elif not shots[0].recorded.has_drive:
        text = "the drive is not recorded along with the response: it is taken for what was played each time"
        yield Remark(f"{text}, and how late responses come after it cannot be determined", is_warning=False)
    elif delay is None:
        text = "how late responses come after drives cannot be determined without --model FILE or --delay SAMPLES"
        yield Remark(text, is_warning=False)
    elif delay.is_told and not isinstance(made, Setup):
        yield Remark(
            f"the response comes {delay.text} samples after the drive: what of that is the chain's "
            " delay and what the vibrator's own, cannot be determined without --model FILE or --delay SAMPLES",
            is_warning=False,
        )


def _of_wires(shots: Sequence[FoundShot], made: Setup | Judging) -> Iterator[Remark]:
    """Say which responses are inverted, which without a model is not refused, and what of the wires cannot be told."""
    for side in made.places[0].sensors:
        signs = [(shot.number, sign) for shot in shots for number, sign in _signs(shot, made) if number == side + 1]
        some = [number for number, sign in signs if sign.is_inverted and sign.is_sure]
        if some:
            yield Remark(f"{numbered(some)}: response {side + 1} is inverted against the reference")
    for kind in ("drives", "responses"):
        found = [exchange for shot in shots if (exchange := getattr(shot.seen, kind)) is not None]
        if not any(each.is_sure for each in found) and len(made.places[0].sensors) > 1:
            sure = f", confidence {100 * max(each.confidence for each in found):.0f} %" if found else ""
            by = "signals are too alike" if found else "that takes a model or a reference that differs by side"
            yield Remark(f"whether {kind} are exchanged cannot be determined ({by}{sure})", is_warning=False)
    if not any(sign.is_sure for shot in shots for _, sign in _signs(shot, made)):
        yield Remark(
            "whether responses are inverted cannot be determined: they do not resemble the reference", is_warning=False
        )


def _signs(shot: FoundShot, made: Setup | Judging) -> Iterator[tuple[int, Sign]]:
    """Return the polarity of responses by their number, from 1."""
    for side, sign in zip(made.places[0].sensors, shot.seen.polarity, strict=True):
        yield side + 1, sign


def _wired(kind: str, exchange: Exchange) -> str:
    """Say how channels seem to be wired."""
    moved = [number + 1 for number, (channel, _) in enumerate(exchange.wires) if channel != number]
    turned = [number + 1 for number, (_, sign) in enumerate(exchange.wires) if sign < 0]
    parts = []
    if moved:
        parts.append(f"{kind}s {' and '.join(map(str, moved))} seem to be exchanged")
    if turned:
        parts.append(f"{kind} {' and '.join(map(str, turned))} seems to be inverted against the others")
    return f"{', '.join(parts)} (confidence {100 * exchange.confidence:.1f} %)"


def _is_amid(fault: SampleFault, shot: FoundShot, made: Setup | Judging) -> bool:
    """Whether equal samples lie where the reference moves, and so are no silence."""
    first, end = fault.first - shot.placed.response, fault.end - shot.placed.response
    if first <= 0 or end >= made.shot.sounded:
        return False
    reference, beside = made.reference.signal, round(BESIDE * made.shot.rate)
    near = np.abs(reference[max(first - beside, 0) : end + beside])
    return bool(near.max() > AUDIBLE * np.abs(reference).max())


def _told(fault: SampleFault, name: str, more: int, rate: float) -> str:
    """Say where and how samples are no measurement."""
    at = f"{name} at {fault.first / rate:.4f} s, {fault.end - fault.first} samples of {fault.value:.6g}"
    what = "clipped" if fault.kind == "clipped" else "a dropout"
    return f"{what}, {at}, and {more} more"
