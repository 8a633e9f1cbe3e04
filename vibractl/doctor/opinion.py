"""From what was measured to a verdict: the limits, and what to do about each fault."""

import numpy as np

from rigkit.verdict import Grade, Verdict, graded, unmeasured
from vibractl.config import RigConfig
from vibractl.decibels import decibels
from vibractl.doctor.chain import Cable, Clock
from vibractl.doctor.coils import Answers, assignment, polarity
from vibractl.doctor.silence import Hum
from vibractl.loopback import TRUST
from vibractl.proof import SLIP

WANTED, WORST = -20.0, -10.0
"""dB re the objective: a tenth of it is wanted, a third of it is the most that leaves room for the rest."""
GAIN_RANGE = (-20.0, 14.0)
"""dB, of the loopback cable: quieter drowns in noise, louder clips with what the cable carries in a shot."""
DEVIATION_WANTED, DEVIATION_WORST = 0.1e-6, 1e-6
"""Within one card it is 0; two crystals differ by 5e-6 and more.  1e-6 is a quarter of a sample in a shot of 6 s."""
CLOCK_TRUST = 0.99
"""Least quality of a stretch: a lost block of 512 samples of its 16 384 gives 0.985."""
CLEARLY = 3.0
"""dB by which a coil's own accelerometer must be the loudest."""
HEARD = 10.0
"""dB over silence."""
ALIKE = 0.5
"""Likeness from which a polarity is certain."""


def loopback_verdict(found: Cable, elsewhere: int | None, config: RigConfig) -> Verdict:
    """Judge the loopback cable.

    Parameters
    ----------
    found : Cable
    elsewhere : int or None
        The accelerometer, counted from 1, on whose input the chirps were heard instead.
    config : RigConfig
    """
    audio = config.audio
    low, high = GAIN_RANGE
    limit = f"quality >= {TRUST}, upright, {low:g} to {high:g} dB"
    ends = f"output {audio.loopback_output} to input {audio.loopback_input}"
    if not found.quality >= TRUST:
        measured = f"no loopback signal: quality {found.quality:.3f}"
        advice = f"put a cable from {ends}, and check that input's gain"
        if elsewhere is not None:
            measured += f"; it shows on response {elsewhere}"
            advice = (
                f"the cable is in input {audio.response_channels[elsewhere - 1]}, must be in {audio.loopback_input}"
            )
        return Verdict("loopback", "fail", measured, limit, advice, found.quality, "1")
    gain = float(decibels(found.gain))
    detail = {"delay_samples": found.delay, "quality": found.quality, "gain_db": gain}
    late = f"{found.delay:.2f} samples ({1000 * found.delay / audio.rate:.2f} ms) late, {gain:+.1f} dB"
    if found.gain < 0:
        advice = "the cable or an input inverts: swap its two wires, or use another input"
        return Verdict("loopback", "fail", f"inverted; {late}", limit, advice, found.quality, "1", detail)
    fits = low <= gain <= high
    advice = "" if fits else f"set the gain of input {audio.loopback_input} so that the cable has about 0 dB"
    return Verdict("loopback", "pass" if fits else "warn", late, limit, advice, found.quality, "1", detail)


def clock_verdict(found: Clock) -> Verdict:
    """Judge the clocks: the rates of input and output against each other, and whether samples went missing."""
    ppm = 1e6 * found.deviation
    apart = abs(found.deviation) > DEVIATION_WORST  # which costs quality as well
    lost = not found.slip <= SLIP or not (found.quality >= CLOCK_TRUST or apart)
    grade: Grade = "fail" if lost else graded(abs(found.deviation), DEVIATION_WANTED, DEVIATION_WORST)
    seconds = found.time[-1] - found.time[0]
    rate = f"{round(ppm, 4) + 0.0:g} ppm over {seconds:.1f} s"
    measured = f"{rate}, largest step {found.slip:.3f} samples, quality {found.quality:.3f}"
    limit = f"{1e6 * DEVIATION_WANTED:g} ppm; {SLIP} samples; {CLOCK_TRUST}"
    advice = ""
    if lost:
        advice = "samples are lost or repeated unsaid: larger audio.blocksize, another driver, no resampler between"
    elif grade != "pass":
        advice = "input and output have two clocks: use one interface for both, or lock them by word clock"
    detail = {"deviation_ppm": ppm, "slip_samples": found.slip, "quality": found.quality}
    return Verdict("clock", grade, measured, limit, advice, ppm, "ppm", detail)


def recordings_verdict(emissions: int, discarded: list[str], late: int) -> Verdict:
    """Judge how many recordings could be used at once; a discarded one was made again."""
    measured = f"{len(discarded)} of {emissions + len(discarded)} discarded, {late} callbacks late"
    if discarded:
        measured += f": {discarded[0]}"
    advice = ""
    if discarded or late:
        advice = "larger audio.blocksize, fewer programs beside, lower input gain where it says clipped"
    grade: Grade = "warn" if discarded or late else "pass"
    detail = {"discarded": float(len(discarded)), "late": float(late)}
    return Verdict(
        "recordings", grade, measured, "none discarded, none late", advice, float(len(discarded)), "1", detail
    )


def hum_verdict(found: Hum, config: RigConfig) -> Verdict:
    """Judge mains hum by the harmonics that lie where the objective is judged."""
    quality = config.quality
    judged = (found.frequency >= quality.above) & (found.frequency <= quality.judged_to)
    if not judged.any():
        return Verdict("hum", "pass", f"no harmonic of {found.mains:g} Hz is judged", "")
    worst = int(np.argmax(np.where(judged, found.level, -np.inf)))
    root = int(np.argmax(np.where(judged, -np.inf, found.level))) if not judged.all() else worst
    level = float(found.level[worst])
    measured = f"{level:.1f} dB re reference at {found.frequency[worst]:g} Hz, response {found.response[worst]}"
    if root != worst:
        measured += (
            f"; below {quality.above:g} Hz, not judged: {found.level[root]:.1f} dB at {found.frequency[root]:g} Hz"
        )
    detail = {f"{place:g}_hz_db": float(size) for place, size in zip(found.frequency, found.level, strict=True)}
    advice = f"response {found.response[worst]}: balanced cable, one ground, away from mains and transformers"
    return _against_objective("hum", level, measured, config, advice, detail)


def noise_verdict(middle: np.ndarray, level: np.ndarray, config: RigConfig) -> Verdict:
    """Judge the noise floor by its worst octave where the objective is judged.

    Parameters
    ----------
    middle : array, shape (octaves,), Hz
    level : array, shape (octaves, responses), dB re reference
    config : RigConfig
    """
    judged = middle * np.sqrt(2) > config.quality.above
    octave, response = np.unravel_index(np.argmax(np.where(judged[:, None], level, -np.inf)), level.shape)
    worst = float(level[octave, response])
    measured = f"{worst:.1f} dB re reference in the octave about {middle[octave]:g} Hz, response {response + 1}"
    detail = {
        f"octave_{place:g}_hz_response_{side + 1}_db": float(size)
        for place, sizes in zip(middle, level, strict=True)
        for side, size in enumerate(sizes)
    }
    advice = f"response {response + 1}: more gain before the converter, another sensor range, quieter surroundings"
    return _against_objective("noise", worst, measured, config, advice, detail)


def distortion_verdict(level: float, noise: float, worst: float, dbfs: float, config: RigConfig) -> Verdict:
    """Judge the converters by the products of two tones over the cable.

    Parameters
    ----------
    level, noise : float, dB re the tones
    worst : float, Hz
    dbfs : float, dB re full scale, peak of the tones
    config : RigConfig
    """
    at_noise = f", all of it noise ({noise:.1f} dB)" if level < noise + 3 else f", most at {worst:g} Hz"
    measured = f"{level:.1f} dB re two tones of {dbfs:g} dBFS{at_noise}"
    advice = "lower the output's or the input's gain; a converter or cable that is not linear cannot be learned away"
    return _against_objective("distortion", level, measured, config, advice, {"noise_db": noise})


def map_verdict(found: Answers, config: RigConfig) -> Verdict:
    """Judge whether each coil's own accelerometer is the one that answers."""
    level = decibels(np.sqrt(np.mean(np.abs(found.response) ** 2, axis=0)))
    owner, margin = assignment(level)
    sides = range(min(level.shape))
    detail = {f"response_{r + 1}_coil_{c + 1}_db": float(level[r, c]) for r, c in np.ndindex(*level.shape)}
    limit = f"{CLEARLY:g} dB over the others, {HEARD:g} dB over silence"
    silent = [coil + 1 for coil in sides if not found.loudness[:, coil].max() >= HEARD]
    if silent:
        out = ", ".join(str(config.audio.drive_channels[coil - 1]) for coil in silent)
        measured = f"coil {', '.join(map(str, silent))} reaches no accelerometer"
        advice = f"amplifier on output {out}: is it on, and connected?"
        return Verdict("channel map", "fail", measured, limit, advice, margin, "dB", detail)
    wrong = [coil for coil in sides if owner[coil] != coil]
    deaf = [side + 1 for side in sides if not found.loudness[side].max() >= HEARD]
    if deaf:
        inputs = ", ".join(str(config.audio.response_channels[side - 1]) for side in deaf)
        measured, advice = (
            f"response {', '.join(map(str, deaf))} responds to no coil",
            f"accelerometer on input {inputs}?",
        )
        return Verdict("channel map", "fail", measured, limit, advice, margin, "dB", detail)
    if wrong:
        told = ", ".join(f"coil {coil + 1} on response {owner[coil] + 1}" for coil in wrong)
        channels = [config.audio.response_channels[owner[coil]] for coil in sides]
        advice = f"swap the cables, or set audio.response_channels = {channels}"
        return Verdict("channel map", "fail", f"largest response: {told}", limit, advice, margin, "dB", detail)
    measured = f"each coil is loudest on its own accelerometer, by {margin:.1f} dB or more"
    advice = "" if margin >= CLEARLY else "hardly distinguishable: check by tapping each shell"
    return Verdict(
        "channel map", "pass" if margin >= CLEARLY else "warn", measured, limit, advice, margin, "dB", detail
    )


def polarity_verdict(found: Answers, mapped: bool) -> Verdict:
    """Judge whether all sides move the same way for the same voltage, at low frequency.

    Parameters
    ----------
    found : Answers
    mapped : bool
        Whether each coil is heard on its own accelerometer; nothing can be said otherwise.
    """
    likeness = polarity(found)
    if not mapped:
        return unmeasured("polarity", "coils and accelerometers are mixed up")
    if len(likeness) == 1:
        return Verdict("polarity", "pass", "one side: nothing to compare", "")
    side = int(np.argmin(likeness))
    worst = float(likeness[side])
    grade: Grade = "pass" if worst >= ALIKE else "fail" if worst <= -ALIKE else "warn"
    place = f"at {found.frequency[0]:.0f} Hz and a little above"
    measured, advice = f"all sides move as side 1, likeness {worst:.2f} {place}", ""
    if grade == "fail":
        measured = f"side {side + 1} moves against side 1, likeness {worst:.2f} {place}"
        advice = f"swap the wires of coil {side + 1} or of accelerometer {side + 1}, unless they are meant to oppose"
    elif grade == "warn":
        measured = f"side {side + 1} moves neither with nor against side 1, likeness {worst:.2f} {place}"
        advice = "a resonance lies there, or the sides differ: check by hand"
    detail = {f"side_{n + 1}": float(value) for n, value in enumerate(likeness)}
    return Verdict("polarity", grade, measured, f"likeness >= {ALIKE}", advice, worst, "1", detail)


def _against_objective(
    check: str, level: float, measured: str, config: RigConfig, advice: str, detail: dict[str, float]
) -> Verdict:
    """Grade a level, dB re reference, by a tenth and a third of the objective."""
    objective = config.quality.objective
    grade = graded(level, objective + WANTED, objective + WORST)
    limit = f"{objective + WANTED:g} dB, a tenth of the objective"
    return Verdict(check, grade, measured, limit, "" if grade == "pass" else advice, level, "dB", detail)
