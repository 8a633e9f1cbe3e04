"""The population of vibrators: the same everywhere, within its ranges, and each within reach of its rig file."""

import hashlib
import subprocess
import sys
from collections.abc import Iterator
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from firmware_sim.laboratory import Laboratory, Wiring, plant_block
from firmware_sim.plants.exciter import Exciter, linear_response
from firmware_sim.population import Vibrator, surroundings
from firmware_sim.population.draw import Draw
from firmware_sim.population.measured_responses import DATA
from firmware_sim.population.references import drive_for
from firmware_sim.population.streams import Streams
from firmware_sim.population.vibrator_draw import draw_machine
from firmware_sim.population.vibrators import MEASURED, VIBRATORS
from rigkit.config import load
from rigkit.toml_text import value_text
from tests.firmware_sim.population.census import all_draws, numbers
from vibractl.config import RigConfig
from vibractl.reference import reference_from

RATE = 44_100
CHECKSUMS = {
    ("shell", 11): "b407a082697e5ee5",
    ("lumped", 12): "b45c4a2fd94c8a37",
    ("flextensional", 13): "c99e8eeff5efee83",
}
"""Of all that was drawn, rounded to four digits."""
ALL = "0435ecf57b0fbd35"
"""Of some quantities of the first hundred seeds."""


def draws() -> list[Draw]:
    """Draw the first seeds, once."""
    return all_draws(VIBRATORS, 100)


def exciter(family: str, seed: int) -> Exciter:
    """Return a machine's whole description."""
    whole: Exciter = draw_machine(family, seed).respond.args[0]  # type: ignore[attr-defined]
    return whole


def parts(thing: Any) -> Iterator[float]:
    """Return every number in records of records, arrays among them."""
    if isinstance(thing, np.ndarray):
        yield from np.abs(thing).ravel()  # signs and phases of modes are nobody's
    elif hasattr(thing, "__dataclass_fields__"):
        for name in thing.__dataclass_fields__:
            yield from parts(getattr(thing, name))
    else:
        yield float(thing)


def fingerprint(family: str, seed: int) -> str:
    """Return the hash of a machine, rounded: linear algebra differs in its last bits from machine to machine."""
    whole = exciter(family, seed)
    frequency = np.array([17.0, 53.0, 211.0, 640.0])
    records = (whole.coils, whole.elements, whole.reception, whole.drift, whole.structure.poles)
    listed = [
        *(number for record in records for number in parts(record)),
        *np.abs(linear_response(whole, frequency)).ravel(),
    ]
    return hashlib.sha256(" ".join(f"{number:.3e}" for number in listed).encode()).hexdigest()[:16]


@pytest.mark.parametrize(("family", "seed"), CHECKSUMS)
def test_a_seed_is_the_same_machine_everywhere(family: str, seed: int) -> None:
    assert fingerprint(family, seed) == CHECKSUMS[family, seed]


@pytest.mark.slow
def test_all_seeds_are_the_same_machines_everywhere() -> None:
    """To three digits, which linear algebra of any processor agrees in."""
    whole = hashlib.sha256()
    for draw in draws():
        names = ("coils", "modes", "first resonance", "last resonance", "least damping", "amplifier gain", "hum")
        values = [each.value for each in draw.quantities if each.name in names]
        whole.update(f"{draw.family} {[f'{value:.2e}' for value in values if value != 'silent']}".encode())
    assert whole.hexdigest()[:16] == ALL


def test_drawing_one_more_property_does_not_redraw_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    before = fingerprint("lumped", 12)
    drawn = surroundings.draw_drift

    def with_colour(streams: Streams, *rest: Any) -> Any:
        assert streams("colour").random(1000).size == 1000
        return drawn(streams, *rest)

    monkeypatch.setattr("firmware_sim.population.vibrator_draw.draw_drift", with_colour)
    assert fingerprint("lumped", 12) == before


@pytest.mark.slow
def test_a_family_is_another_machine_of_the_same_seed() -> None:
    sums = [fingerprint(family, 5) for family in VIBRATORS.families]
    assert len(set(sums)) == 3
    assert {draw.family for draw in draws()} == set(VIBRATORS.families)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "low", "high", "reached"),
    [
        ("coils", 1, 4, (1, 4)),
        ("sensors", 1, 4, (1, 4)),
        ("modes", 6, 60, (8, 58)),
        ("first resonance", 8, 60, (9, 55)),
        ("least damping", 0.002, 0.08, (0.0021, 0.015)),
        ("most damping", 0.002, 0.08, (0.005, 0.07)),
        ("singular values apart", 1, 300, (1.01, 250)),
        ("drive needed over reference, rms", 0.003, 3, (0.004, 2)),
        ("mains", 49.95, 60.05, (49.96, 60.04)),
        ("hum", -40, 10, (-38, 8)),
        ("white noise", -60, -16, (-58, -18)),
        ("a ship", -20, 10, (-18, 8)),
    ],
)
def test_what_is_drawn_is_within_its_range_and_reaches_to_its_ends(
    name: str, low: float, high: float, reached: tuple[float, float]
) -> None:
    found = numbers(draws(), name)
    assert low * (1 - 1e-6 * np.sign(low)) <= found.min() <= reached[0]
    assert reached[1] <= found.max() <= high * (1 + 1e-6 * np.sign(high))


@pytest.mark.slow
def test_delays_are_of_1_to_30_ms_with_fractions_of_a_sample() -> None:
    delays = np.concatenate([each.value for draw in draws() for each in draw.quantities if each.name == "delays"])
    assert 1.0 <= delays.min() < 1.5
    assert 25.0 < delays.max() <= 30.0
    fractions = 1e-3 * delays * RATE % 1
    assert np.histogram(fractions, 5, (0, 1))[0].min() > 0.1 * len(delays)


@pytest.mark.slow
def test_distortion_is_any_mix_from_none_to_as_loud_as_the_reference() -> None:
    mixes = [
        {each.name.removeprefix("distortion by "): each.value for each in draw.quantities if "distortion" in each.name}
        for draw in draws()
    ]
    loudest = np.array([max(mix.values()) for mix in mixes if mix])
    assert 0.03 < np.mean([not mix for mix in mixes]) < 0.15
    assert loudest.min() < -50
    assert -3 < loudest.max() <= 0.1
    pairs = {pair for mix in mixes for pair in combinations(sorted(mix), 2)}
    assert len(pairs) == 6 * 5 / 2
    assert len({tuple(sorted(mix)) for mix in mixes}) > 30


def test_there_are_all_kinds_of_drift_of_hum_and_of_sensors() -> None:
    names = [{each.name: each.value for each in draw.quantities} for draw in draws()]
    assert {each["drift"] for each in names} == {"still", "walk", "trend", "jump"}
    assert 0.1 < np.mean([each["hum"] == "silent" for each in names]) < 0.3
    for part in ("resonant sensor", "nonlinear sensor", "1/f noise", "ships"):
        assert 0.2 < np.mean([any(part in name for name in each) for each in names]) < 0.8
    assert {round(value) for value in numbers(draws(), "mains")} == {50, 60}


@pytest.mark.parametrize("seed", range(0, 100, 20))
def test_its_reference_is_within_reach_of_its_limits_as_the_program_has_them(seed: int) -> None:
    """The drive of the linear inverse, of the reference that the program itself makes."""
    draw = draws()[seed]
    config = load(None, RigConfig, [f"{key}={value_text(value)}" for key, value in draw.keys.items()])
    machine = draw_machine(draw.family, seed)
    wanted = config.reference
    reference = reference_from(wanted.signal, RATE, wanted.amplitude, wanted.taper, 1, 1).signal[:, 0]
    own = machine.references[0].signal[: round(5 * 512)] * wanted.amplitude
    np.testing.assert_allclose(
        np.abs(np.fft.rfft(own))[:500] / 512,
        np.abs(np.fft.rfft(reference))[:500] / RATE,
        atol=0.05 * np.abs(np.fft.rfft(own)).max() / 512,
    )
    drive = wanted.amplitude * drive_for(machine.respond, machine.references[0])
    assert np.abs(drive).max() < 0.6 * config.limits.peak
    assert np.sqrt((drive[: 5 * 512] ** 2).mean(axis=0)).max() < config.limits.rms
    assert np.abs(np.diff(drive, axis=0)).max() * 512 < config.limits.slew
    assert config.limits.peak < config.audio.output_full_scale
    assert config.audio.input_full_scale >= (40 - 1e-9) * wanted.amplitude


@pytest.mark.parametrize("seed", range(0, 100, 9))
def test_its_rig_file_wires_the_card_for_it(seed: int) -> None:
    config = load(None, RigConfig, [f"{key}={value_text(value)}" for key, value in draws()[seed].keys.items()])
    laboratory = Laboratory(plant_block(config.simulator.plant, config.simulator.options), Wiring.of(config.audio))
    assert laboratory.plant.inputs[0].width == len(config.audio.drive_channels)


def of_silence(draw: Draw) -> tuple[np.ndarray, np.ndarray]:
    """Return the lines of five seconds without drive from 100 to 645 Hz, dB re the limit, and their frequencies, Hz."""
    block = Vibrator(seed=draw.seed, family=draw.family)
    block.prepare(float(RATE), 5 * RATE)
    heard = np.zeros((5 * RATE, block.outputs[0].width))
    block.process(np.zeros((5 * RATE, block.inputs[0].width)), heard)
    limit = 0.01 * draw.keys["reference.amplitude"] * draw_machine(draw.family, draw.seed).references[0].line
    lines = 20 * np.log10(np.abs(np.fft.rfft(heard, axis=0)[500:3_226]).max(axis=1) / RATE / limit)
    return lines, np.arange(500, 3_226) / 5


def test_hum_is_as_loud_a_line_as_the_draw_says() -> None:
    """Between two lines it is up to 4 dB fainter than on one."""
    loud = [
        draw
        for draw in draws()
        if any(each.name == "hum" and each.value != "silent" and each.value > 0 for each in draw.quantities)
    ]
    for draw in loud[:4]:
        said = {each.name: each.value for each in draw.quantities}
        lines, frequency = of_silence(draw)
        assert said["hum"] - 4.5 < lines.max() < said["hum"] + 2
        harmonic = frequency[lines.argmax()] / said["mains"]
        assert abs(harmonic - round(harmonic)) * said["mains"] < 1


def test_white_noise_is_as_loud_as_the_draw_says() -> None:
    def only_white(draw: Draw) -> bool:
        names = {each.name for each in draw.quantities}
        silent = any(each.name == "hum" and each.value == "silent" for each in draw.quantities)
        return silent and not {"ships", "swell"} & names and draw.keys["reference.amplitude"] > 1

    draw = next(draw for draw in draws() if only_white(draw) and draw.keys["audio.response_channels"] == [1])
    lines, _ = of_silence(draw)
    said = next(each.value for each in draw.quantities if each.name == "white noise")
    assert 10 * np.log10(np.mean(10 ** (lines / 10))) == pytest.approx(said, abs=3.5)  # sensors differ by up to 3 dB


@pytest.mark.parametrize("family", VIBRATORS.families)
def test_a_block_of_it_runs_at_its_own_widths(family: str) -> None:
    block = Vibrator(seed=3, family=family)
    block.prepare(44_100.0, 512)
    drive = np.random.default_rng(1).standard_normal((512, block.inputs[0].width))
    heard = np.zeros((512, block.outputs[0].width))
    for _ in range(4):
        block.process(drive, heard)
    assert np.isfinite(heard).all()
    assert heard.any()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_it_stays_finite_at_its_limit(seed: int) -> None:
    draw = draws()[seed]
    block = Vibrator(seed=seed)
    block.prepare(float(RATE), RATE)
    rng = np.random.default_rng(seed)
    drive = draw.keys["limits.peak"] * np.clip(rng.standard_normal((RATE, block.inputs[0].width)), -1, 1)
    heard = np.zeros((RATE, block.outputs[0].width))
    for _ in range(2):
        block.process(drive, heard)
        assert np.isfinite(heard).all()


def test_a_family_or_seed_that_there_is_not_is_refused_by_name() -> None:
    with pytest.raises(
        ValueError, match="family of vibrator is 'bell', must be shell, lumped, flextensional, measured"
    ):
        Vibrator(seed=1, family="bell")
    with pytest.raises(ValueError, match="seed is -1, must be a whole number >= 0"):
        Vibrator(seed=-1)


def test_measured_responses_are_read_by_their_own_family_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    assert MEASURED not in {draw.family for draw in draws()}
    monkeypatch.setattr("firmware_sim.population.measured_responses.DATA", DATA / "nowhere")
    for name in ("head", "room"):
        monkeypatch.setattr(f"firmware_sim.population.measured_responses.{name}.__defaults__", (DATA / "nowhere",))
    with pytest.raises(ValueError, match="family measured wants .*nowhere.*, which is not there"):
        Vibrator(seed=1, family=MEASURED)
    Vibrator(seed=1)


@pytest.mark.sample(2)
@pytest.mark.skipif(not DATA.exists(), reason=f"{DATA} is not here")
@pytest.mark.parametrize("seed", range(4))
def test_measured_responses_respond_as_they_were_measured(seed: int) -> None:
    draw = VIBRATORS.draw(seed, MEASURED)
    block = Vibrator(seed=seed, family=MEASURED)
    block.prepare(44_100.0, 512)
    drive, heard = np.zeros((512, 2)), np.zeros((512, 2))
    for _ in range(8):
        block.process(drive, heard)
    assert np.isfinite(heard).all()
    assert draw.keys["audio.drive_channels"] == [1, 2]
    with pytest.raises(ValueError, match="rate is 48000.0 samples/s, must be 44100"):
        block.prepare(48_000.0, 512)


def test_importing_the_population_imports_nothing_heavy() -> None:
    code = (
        "import sys, firmware_sim.population; print(sorted({'numpy', 'numba', 'scipy', 'pydantic'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
