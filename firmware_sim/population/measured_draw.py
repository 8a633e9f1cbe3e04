"""The family `measured`: an amplifier before responses that others measured.  Only this family reads files."""

from functools import partial

import numpy as np

from firmware_sim.plants.measured_exciter import MeasuredExciter, MeasuredExciterPlant, measured_response
from firmware_sim.plants.reception import silent_reception
from firmware_sim.plants.steady_kernel import clip_softly
from firmware_sim.population import measured_responses
from firmware_sim.population.distortion import LOUDEST, NONE, found
from firmware_sim.population.draw import Quantity
from firmware_sim.population.machine import Machine, draw_level
from firmware_sim.population.references import draw_references, needed
from firmware_sim.population.sensing import draw_reception, draw_sensors
from firmware_sim.population.streams import Streams

RINGS = {"room": 0.15, "head": 0.01}
"""s, time constant of the decay."""
IN_A_ROOM = 1 / 3
WIDTH = 2
SAMPLES = 256
"""Of a period, in which the drive's overtones are worked out."""


def draw_measured(family: str, seed: int) -> Machine:
    """Draw which responses, and what is around them.

    Raises
    ------
    ValueError : the files are not there.
    """
    streams = Streams(seed, "vibrator", family)
    taps, place, said = _responses(streams)
    sensors, sensing = draw_sensors(streams, WIDTH)
    references = draw_references(streams, 0.0)
    rate = float(measured_responses.RATE)
    whole = MeasuredExciter(taps, rate, 0.0, 1, silent_reception(sensors))
    sensitivity, level = draw_level(streams)
    need = needed(partial(measured_response, whole), references[0])
    gain = float(np.sqrt(2)) * need.rms / sensitivity
    clip, sharpness, clipping = _clip(streams, level * need.peak / gain)
    reception, surrounding = draw_reception(streams, sensors, level, references[0].line)
    whole = MeasuredExciter(taps * gain, rate, clip, sharpness, reception)
    return Machine(
        partial(MeasuredExciterPlant, whole, seed=seed),
        partial(measured_response, whole),
        (WIDTH, WIDTH),
        RINGS[place],
        float(sensors.delay.max()),
        references,
        level,
        (Quantity("coils", WIDTH), Quantity("sensors", WIDTH), *said, *clipping, *sensing, *surrounding),
    )


def _responses(streams: Streams) -> tuple[np.ndarray, str, tuple[Quantity, ...]]:
    rng = streams("place")
    in_a_room, angles = rng.uniform() < IN_A_ROOM, rng.choice(measured_responses.HEADS, 2)
    if in_a_room:
        return measured_responses.room(), "room", (Quantity("measured in", "a room"),)
    left, right = (int(angle) for angle in angles)
    said = Quantity("measured at", "a head"), Quantity("loudspeakers", (left, right), "degrees")
    return measured_responses.head(left, right), "head", said


def _clip(streams: Streams, peak: float) -> tuple[float, int, tuple[Quantity, ...]]:
    """Draw how loud the overtones of a sine of the drive's peak, V, are re itself, and find where that clips."""
    sharpness = int(streams("law").choice([1, 2, 4]))
    if streams("any distortion").uniform() < NONE:
        return 0.0, sharpness, ()
    wanted = float(streams("distortion").uniform(*LOUDEST))
    sine = peak * np.sin(2 * np.pi * np.arange(SAMPLES) / SAMPLES)[:, None]
    clipped = np.zeros_like(sine)

    def level(clip: float) -> float:
        clip_softly(sine, clip, sharpness, clipped)
        size = np.abs(np.fft.rfft(clipped[:, 0]))
        return float(size[2:].max() / size[1])

    clip = found(level, 10 ** (wanted / 20), 0.05 * peak, 300 * peak)
    return clip, sharpness, (Quantity("distortion by soft clipping", 20 * np.log10(level(clip)), "dB"),)
