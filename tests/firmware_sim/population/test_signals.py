"""Records for identification: what is in them is what their truth says."""

import hashlib
import json
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from firmware_sim import __main__ as firmware_sim
from firmware_sim.population.excitations import EXCITATIONS, Damage
from firmware_sim.population.signal_population import SIGNALS
from firmware_sim.population.signals import Record, SignalSource, foreign_noise, signal
from firmware_sim.population.streams import Streams
from firmware_sim.population.systems import SYSTEMS

SEEDS = 300
CHECKSUMS = {
    ("modes", 21): "179aa43274f17960",
    ("similar", 22): "7232cfe882a36acc",
    ("cascade", 23): "8ca0a33756e5b4e3",
}


@cache
def sources() -> list[SignalSource]:
    """Draw the first so many seeds."""
    return [signal(SIGNALS.family(seed), seed) for seed in range(SEEDS)]


@cache
def records() -> list[tuple[SignalSource, Record]]:
    """Record a hundred of them, shortly."""
    return [(source, source.record(600)) for source in sources()[:100]]


@pytest.mark.parametrize(("family", "seed"), CHECKSUMS)
def test_a_seed_is_the_same_record_everywhere(family: str, seed: int) -> None:
    source = signal(family, seed)
    record = source.record(500)
    numbers = [*np.abs(source.truth.poles), *record.measured[::50].ravel(), source.clear]
    text = " ".join(f"{number:.3e}" for number in numbers)
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == CHECKSUMS[family, seed]


def test_orders_go_from_1_to_40_and_all_kinds_happen() -> None:
    orders = [len(source.truth.dynamics) for source in sources()]
    assert (min(orders), max(orders)) == (1, 40)
    assert {source.family for source in sources()} == set(SYSTEMS)
    assert {source.excitation for source in sources()} == set(EXCITATIONS)
    mixed = {name.split(" to ")[0] for source in sources() for name in source.mixed}
    assert mixed == {
        "dead time", "closed loop", "integrators", "unstable pole", "trends", "spikes", "quantised", "gaps held",
        "gaps missing",
    }  # fmt: skip
    assert any(not source.mixed for source in sources())
    widths = {source.truth.direct.shape for source in sources()}
    assert {width for pair in widths for width in pair} == {1, 2, 3, 4}


def test_poles_are_where_the_label_says() -> None:
    for source in sources():
        poles = np.abs(source.truth.poles)
        assert (poles > 1 + 1e-4).sum() == ("unstable pole" in source.mixed)
        assert (np.abs(source.truth.poles - 1) < 1e-6).any() == ("integrators" in source.mixed)
        assert source.in_loop or poles.max() < 1


def test_every_record_is_finite_but_where_samples_are_missing_and_none_runs_away() -> None:
    for source, record in records():
        missing = np.isnan(record.measured).any(axis=1)
        assert missing.any() == ("gaps missing" in source.mixed)
        stretches = np.zeros(len(missing), bool)
        for start, end in record.gaps:
            stretches[start:end] = True
        assert not missing[~stretches].any()
        assert np.nanmax(np.abs(record.measured)) < 1e5
        assert np.nanmax(np.abs(record.given)) < 1e4


def test_what_is_measured_is_the_truth_s_answer_to_what_was_given_and_noise() -> None:
    """Of the records that nothing spoiled, in loops as well."""
    clean = [(source, record) for source, record in records() if source.damage == Damage(kept=source.damage.kept)]
    assert len(clean) > 15
    assert any(source.in_loop for source, _ in clean)
    for source, record in clean:
        if "unstable pole" in source.mixed:
            continue  # alone it runs away from rounding errors
        _, answer = source.truth.run(record.given, record.noise)
        np.testing.assert_allclose(record.measured, answer, rtol=1e-6, atol=1e-6 * np.abs(answer).max())


def test_noise_is_as_strong_as_it_says_and_has_poles_of_its_own() -> None:
    for source, record in records():
        if not source.in_loop:
            _, silent = source.truth.run(record.given, 0 * record.noise) if not record.gaps else (None, None)
            if silent is not None:
                ratio = 20 * np.log10(silent.std(axis=0) / record.noise.std(axis=0))
                np.testing.assert_allclose(ratio, source.clear, atol=0.5)
    noise = foreign_noise(Streams(3, "test"), 20_000, 3)
    spectra = np.abs(np.fft.rfft(noise, axis=0)) ** 2
    bands = np.array([part.mean(axis=0) for part in np.array_split(spectra[1:], 16)])
    assert (bands.max(axis=0) > 3 * bands.min(axis=0)).all()
    assert np.abs(np.corrcoef(noise.T)[np.triu_indices(3, 1)]).max() < 0.05


@pytest.mark.parametrize("name", EXCITATIONS)
def test_an_excitation_moves_every_input_about_as_much(name: str) -> None:
    drawn = EXCITATIONS[name](np.random.default_rng(2), 4_000, 3)
    assert drawn.shape == (4_000, 3)
    assert (np.abs(drawn).max(axis=0) > 0.5).all()
    assert 0.2 < drawn.std() < 5


def test_damage_does_what_it_says_and_no_more() -> None:
    rng = np.random.default_rng(4)
    given, measured = rng.standard_normal((10_000, 1)), rng.standard_normal((10_000, 2))
    streams = Streams(5, "test")

    def damaged(damage: Damage) -> tuple[np.ndarray, np.ndarray, list[tuple[int, int]]]:
        after = given.copy(), measured.copy()
        return *after, damage.done(streams, *after)

    _, same, none = damaged(Damage())
    np.testing.assert_array_equal(same, measured)
    assert none == []
    _, spiked, _ = damaged(Damage(spikes=0.01))
    hit = spiked != measured
    assert hit.mean() == pytest.approx(0.01, rel=0.2)
    assert (np.abs(spiked - measured)[hit] > 4.9 * measured.std(axis=0).min()).all()
    _, rounded, _ = damaged(Damage(bits=8))
    assert max(len(np.unique(column)) for column in rounded.T) <= 2**8 + 1
    assert np.abs(rounded - measured).max() <= 0.51 * np.ptp(measured, axis=0).max() / 2**8
    _, moved, _ = damaged(Damage(trend=2.0))
    assert np.abs(np.diff(moved - measured, axis=0)).max() < 0.01
    assert np.abs(moved - measured).max() > 0.5
    held_given, held, gaps = damaged(Damage(gaps=3))
    for start, end in gaps:
        assert (held[start:end] == held[start - 1]).all()
        assert (held_given[start:end] == held_given[start - 1]).all()
    assert len(gaps) == 3


def drawn(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """Run `firmware-sim draw signal` and return its exit status."""
    monkeypatch.setattr(sys, "argv", ["firmware-sim", "draw", "signal", *words])
    return firmware_sim.main()


def test_a_record_and_its_truth_become_files(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    words = ("--seed", "3", "--family", "cascade", "--set", "signal.samples=300")
    assert drawn(monkeypatch, *words, "--out", str(tmp_path / "three")) == 0
    truth = json.loads((tmp_path / "three/truth.json").read_text())
    source = signal("cascade", 3)
    np.testing.assert_allclose(truth["A"], source.truth.dynamics)
    assert truth["mixed"] == list(source.mixed)
    lines = (tmp_path / "three/record.csv").read_text().splitlines()
    assert lines[0].split(",") == truth["inputs"] + truth["outputs"]
    assert len(lines) == 301
    record = source.record(300)
    np.testing.assert_allclose(np.array(lines[7].split(","), float), [*record.given[6], *record.measured[6]], rtol=1e-9)


def test_a_wav_file_holds_the_same_and_refuses_what_is_missing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = next(source for source in sources() if "gaps missing" not in source.mixed)
    words = ("--seed", str(sources().index(whole)), "--set", "signal.samples=300", "--out")
    assert drawn(monkeypatch, *words, str(tmp_path / "a.wav")) == 0
    heard, record = recording.read(tmp_path / "a.wav"), whole.record(300)
    np.testing.assert_allclose(heard.data, np.concatenate([record.given, record.measured], axis=1))
    assert json.loads((tmp_path / "a.json").read_text())["rate"] == heard.rate
    holed = next(source for source in sources() if "gaps missing" in source.mixed)
    capsys.readouterr()
    words = ("--seed", str(sources().index(holed)), "--set", "signal.samples=300", "--out")
    assert drawn(monkeypatch, *words, str(tmp_path / "b.wav")) == 2
    assert "samples are missing in this record, must be a CSV file or a folder" in capsys.readouterr().err
    assert not (tmp_path / "b.wav").exists()
