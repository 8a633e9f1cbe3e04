"""The doctor: a minute of small signals through the guard, and a verdict on every part of the rig."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rigkit.verdict import Verdict, unmeasured
from vibractl import alignment, loopback
from vibractl.audio import GuardLatched, ShotAbandoned
from vibractl.audio_stream import AudioError, channels
from vibractl.capture import Capture, Discarded
from vibractl.config import RigConfig
from vibractl.doctor.bench import Bench
from vibractl.doctor.calibrated import MODEL, model_verdict
from vibractl.doctor.chain import Clock, cable, clock, distortion, two_tones
from vibractl.doctor.coils import Answers, answers, sweep
from vibractl.doctor.opinion import (
    clock_verdict,
    distortion_verdict,
    hum_verdict,
    loopback_verdict,
    map_verdict,
    noise_verdict,
    polarity_verdict,
    recordings_verdict,
)
from vibractl.doctor.silence import Hum, Level, hum, noise, reference_level
from vibractl.proof import LARGEST_ROUND_TRIP
from vibractl.transfer_matrix import TransferMatrix

CHECKS = (
    "card", "recordings", "loopback", "clock", "hum", "noise", "distortion", "channel map", "polarity",
)  # fmt: skip
SILENCE = 10.0
"""s without a drive, chirps on the cable."""
TONES, EDGE = 4.0, 0.1
"""s of two tones on the cable, and of their soft ends beside."""
SWEEP, REST = 2.0, 0.5
"""s of a sweep on each coil, and of the silence after it."""
DRIVE_LEVEL = 10 ** (-30 / 20)
"""of limits.peak."""
_FIRST = 0.5
"""s of chirps that the cable is looked for with: two clocks have not yet drifted apart."""

_NO_CABLE = "use a spare channel for a loopback cable: a marker cannot show this"

Tell = Callable[[float, str], None]


@dataclass
class Examination:
    """What was measured, and what to think of it.

    Parameters
    ----------
    config : RigConfig
    level : Level, of the reference
    verdicts : list of Verdict, in the order of `CHECKS`
    silence : array, shape (samples, responses), m/s^2; empty when nothing could be recorded
    hum : Hum or None
    clock : Clock or None
    answers : Answers or None
    """

    config: RigConfig
    level: Level
    verdicts: list[Verdict]
    silence: np.ndarray
    hum: Hum | None = None
    clock: Clock | None = None
    answers: Answers | None = None

    @property
    def failed(self) -> bool:
        """Whether any verdict fails."""
        return any(verdict.grade == "fail" for verdict in self.verdicts)


def duration(config: RigConfig) -> float:
    """Return how long the examination plays, s."""
    coils = len(config.audio.drive_channels)
    emissions = 2 + coils
    return SILENCE + TONES + 2 * EDGE + coils * (SWEEP + REST) + emissions * LARGEST_ROUND_TRIP


def announcement(config: RigConfig) -> list[str]:
    """Say what will be played, before it is."""
    audio, (low, high) = config.audio, _band(config)
    lines = [
        f"each coil alone: a sweep of {low:g} to {high:g} Hz, {SWEEP:g} s, {DRIVE_LEVEL * config.limits.peak:.3g} V "
        f"(30 dB under limits.peak), on output {', '.join(map(str, audio.drive_channels))}"
    ]
    if audio.alignment == "loopback":
        seconds = SILENCE + TONES
        lines.append(f"the cable: chirps and two tones, {seconds:g} s, -20 dBFS, on output {audio.loopback_output}")
    return lines


def examine(
    config: RigConfig, tell: Tell = lambda _seconds, _what: None, model: TransferMatrix | None = None
) -> Examination:
    """Look at a rig from end to end.

    Parameters
    ----------
    config : RigConfig
    tell : callable(seconds, what)
        Told before each step how much has been played, and what is next.
    model : TransferMatrix, optional
        With which the rig is compared, which is one check more.

    Returns
    -------
    Examination
        With a verdict for each of `CHECKS`, whatever goes wrong.

    Raises
    ------
    ValueError : the settings do not fit together; nothing was played.
    GuardLatched : the guard has shut itself.
    """
    found = Examination(config, reference_level(config), [], np.zeros((0, len(config.audio.response_channels))))
    visit = _Visit(found, tell, model)
    longest = max(SILENCE, TONES + 2 * EDGE, SWEEP + REST)
    try:
        with Bench(config, longest, visit.discarded) as bench:
            visit.run(bench)
            visit.say(_card_verdict(config))
            visit.say(recordings_verdict(visit.emissions, visit.reasons, visit.late))
    except ShotAbandoned as fault:
        advice = "learning is impossible: correct the cause of the failed attempts first"
        visit.say(_card_verdict(config))
        visit.say(Verdict("recordings", "fail", str(fault), "none discarded", advice))
    except GuardLatched:
        raise
    except AudioError as fault:
        visit.say(Verdict("card", "fail", str(fault), "opens and runs", "see [audio] in the rig file, and the cables"))
    said = {verdict.check: verdict for verdict in visit.verdicts}
    why = next(
        (check for check in ("card", "recordings", "loopback") if check in said and said[check].grade == "fail"), ""
    )
    checks = (*CHECKS, MODEL) if model is not None else CHECKS
    found.verdicts = [said.get(check) or unmeasured(check, f"{why} failed") for check in checks]
    return found


class _Visit:
    """One examination under way: what has been played, counted and concluded so far."""

    def __init__(self, found: Examination, tell: Tell, model: TransferMatrix | None) -> None:
        self.found, self.config, self._tell, self._model = found, found.config, tell, model
        self.verdicts: list[Verdict] = []
        self.reasons: list[str] = []
        self.emissions = self.late = 0
        self._played, self._delay = 0.0, 0

    def say(self, verdict: Verdict) -> None:
        self.verdicts.append(verdict)

    def discarded(self, discarded: Discarded) -> None:
        self.reasons.append(discarded.reason)
        self.late += discarded.capture.late

    def run(self, bench: Bench) -> None:
        cabled = self.config.audio.alignment == "loopback"
        sound = self._silence(bench, cabled)
        if sound:
            self._distortion(bench)
        self._coils(bench)
        if not cabled:
            for check in ("loopback", "clock", "distortion"):
                self.say(Verdict(check, "warn", "not measured: audio.alignment is marker", "", _NO_CABLE))

    def _record(self, bench: Bench, drive: np.ndarray, timing: np.ndarray, what: str) -> Capture:
        self._tell(self._played, what)
        capture = bench.record(drive, timing)
        self._played += len(capture.emitted) / self.config.audio.rate
        self.emissions += 1
        self.late += capture.late
        return capture

    def _silence(self, bench: Bench, cabled: bool) -> bool:
        """Record without a drive, chirps on the cable as in a shot; return whether the cable can be trusted."""
        config, rate = self.config, self.config.audio.rate
        chirp = alignment.timing_signal(rate, alignment.LOOPBACK_BAND, loopback.LEVEL)
        count = int(SILENCE * rate) // len(chirp)
        train = alignment.timing_train(chirp, count)
        drive = np.zeros((len(train), len(config.audio.drive_channels)))
        capture = self._record(bench, drive, train if cabled else train[:0], "silence")
        self.found.silence = silence = capture.response.astype(float)
        highest = config.quality.judged_to
        self.found.hum = hum(silence, rate, self.found.level, highest)
        self.say(hum_verdict(self.found.hum, config))
        band = config.learning.band[0], max(highest, config.learning.band[1])
        self.say(noise_verdict(*noise(silence, rate, self.found.level, band), config))
        if not cabled:
            return False
        first = train[: round(_FIRST * rate)]
        within = len(first) + round(LARGEST_ROUND_TRIP * rate)
        back = cable(first, capture.loopback[:within], rate)
        trusted = back.quality >= loopback.TRUST
        heard = [cable(first, each[:within], rate).quality for each in silence.T] if not trusted else []
        self.say(loopback_verdict(back, _where(heard), config))
        if trusted:
            upright = np.sign(back.gain) * capture.loopback.astype(float)
            self.found.clock = clock(chirp, count, upright, back.delay, rate)
            self.say(clock_verdict(self.found.clock))
            self._delay = round(back.delay)
        return trusted

    def _distortion(self, bench: Bench) -> None:
        rate, highest = self.config.audio.rate, self.config.quality.judged_to
        tones = two_tones(rate, TONES + 2 * EDGE, loopback.LEVEL)
        silent = np.zeros((len(tones), len(self.config.audio.drive_channels)))
        capture = self._record(bench, silent, tones, "two tones")
        start = self._delay + round(EDGE * rate)
        steady = capture.loopback[start : start + round(TONES * rate)].astype(float)
        dbfs = 20 * np.log10(loopback.LEVEL)
        self.say(distortion_verdict(*distortion(steady, rate, highest), dbfs, self.config))

    def _coils(self, bench: Bench) -> None:
        config, rate = self.config, self.config.audio.rate
        coils, band = len(config.audio.drive_channels), _band(config)
        wave = sweep(rate, band, SWEEP, DRIVE_LEVEL * config.limits.peak)
        recorded = []
        for coil in range(coils):
            drive = np.zeros((len(wave) + round(REST * rate), coils))
            drive[: len(wave), coil] = wave
            capture = self._record(bench, drive, np.zeros(0), f"sweep on coil {coil + 1}")
            recorded.append(capture.response.astype(float))
        self.found.answers = answers(wave, recorded, self.found.silence, rate, band)
        mapped = map_verdict(self.found.answers, config)
        self.say(mapped)
        self.say(polarity_verdict(self.found.answers, mapped.grade != "fail"))
        if self._model is not None:
            self.say(model_verdict(self.found.answers, self._model, self._delay / rate))


def _where(quality: list[float]) -> int | None:
    """Return the accelerometer, counted from 1, on which the chirps of the cable were heard instead."""
    heard = [number for number, each in enumerate(quality, 1) if each >= loopback.TRUST]
    return heard[0] if heard else None


def _band(config: RigConfig) -> tuple[float, float]:
    """Return where coils are compared: from the lowest frequency learned to the top of the working band."""
    return config.learning.band[0], config.characterisation.preload_band[1]


def _card_verdict(config: RigConfig) -> Verdict:
    audio = config.audio
    inputs, outputs = channels(audio)
    device = f"{audio.stream} {audio.device}".strip()
    measured = f"{device}: {audio.rate} samples/s, {audio.blocksize} a block, {inputs} in, {outputs} out"
    return Verdict("card", "pass", measured, "opens and runs")
