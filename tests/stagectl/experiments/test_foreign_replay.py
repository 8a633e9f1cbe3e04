"""Somebody's log goes through the controllers of a run: in its units, at its rate, and refused by name where it cannot.

Guards against columns that are taken for others, units that are off by a million, and rates that are not the run's.
"""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit.export.parquet_file import write_recording
from stagectl import __main__ as stagectl
from tests.rigkit.mcap_logs import json_log, times
from tests.stagectl.experiments.piezo.test_session import finished

RATE = 250.0


def main(words: list[str]) -> int:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["stagectl", *words])
        return stagectl.main()


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("shared") / "run"
    wanted = path.with_name("wanted.csv")
    step = np.concatenate([np.zeros(50), np.full(450, 1e-4)])[:, None]
    recording.write(wanted, Recording(("x",), ("m",), RATE, step))
    assert main(["midrange", "--scenario", str(wanted), "--controller", "mvpc-aw", "--out", str(path)]) == 0
    return path


def recorded(path: Path) -> Recording:
    return recording.read(path / "recording.wav")


def columns(record: Recording, metre: str = "") -> str:
    units = zip(record.names, record.units, strict=True)
    return ",".join(f"{name}=col_{name}{metre if unit == 'm' else ''}" for name, unit in units)


def micrometres(path: Path, record: Recording, rate: float = RATE) -> Path:
    """Write a table as a data logger would: time, and lengths in um."""
    time = np.arange(len(record.data)) / rate
    data = record.data * [1e6 if unit == "m" else 1.0 for unit in record.units]
    head = ",".join(["time", *(f"col_{name}" for name in record.names)])
    np.savetxt(path, np.column_stack([time, data]), delimiter=",", header=head, comments="", fmt="%.17g")
    return path


def replay(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, float]:
    capsys.readouterr()
    assert main(["replay", *words, "--json", "-"]) == 0
    found: dict[str, float] = json.loads(capsys.readouterr().out)["differences"]
    return found


def test_a_table_in_micrometres_gives_what_was_made(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record, out = recorded(run), tmp_path / "made.csv"
    log = micrometres(tmp_path / "log.csv", record)
    found = replay(capsys, str(run), "--from", str(log), "--map", columns(record, "*1e-6"), "--out", str(out))
    assert found.keys() == {"fast_reference", "slow_reference"}
    assert max(found.values()) < 1e-15
    made = recording.read(out)
    assert made.names == ("fast_reference", "slow_reference")
    np.testing.assert_allclose(made.data, record.select(made.names).data, atol=1e-15)


def test_a_parquet_table_and_a_wav_give_it_bit_for_bit(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = recorded(run)
    write_recording(tmp_path / "log.parquet", record)
    mapped = ",".join(f"{name}={name}" for name in record.names)
    for log in (tmp_path / "log.parquet", run / "recording.wav"):
        assert set(replay(capsys, str(run), "--from", str(log), "--map", mapped).values()) == {0.0}


def test_an_mcap_gives_it_bit_for_bit_and_in_micrometres(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = recorded(run)
    assert main(["export", str(run), "--to", "mcap", "--out", str(tmp_path / "log.mcap")]) == 0
    mapped = ",".join(f"{name}=/recording.{name}" for name in record.names)
    words = (str(run), "--from", str(tmp_path / "log.mcap"), "--map")
    assert set(replay(capsys, *words, mapped).values()) == {0.0}
    data = record.data * [1e6 if unit == "m" else 1.0 for unit in record.units]
    logged = [(time, {"all": row.tolist()}) for time, row in zip(times(len(data), RATE), data, strict=True)]
    json_log(tmp_path / "log.mcap", {"/rig/pair": logged})
    factors = ["*1e-6" if unit == "m" else "" for unit in record.units]
    mapped = ",".join(f"{name}=/rig/pair.all[{n}]{factors[n]}" for n, name in enumerate(record.names))
    assert max(replay(capsys, *words, mapped).values()) < 1e-15
    assert main(["replay", *words, mapped.replace("all[1]", "all[99]")]) == 2
    assert_said(capsys, "/rig/pair has no number all.99 in message 1; there are all.0, all.1")


def test_outputs_need_no_column_and_a_channel_may_be_one_value(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sensors = recorded(run).select(["reference", "relative", "fast", "slow", "position"])
    log = micrometres(tmp_path / "log.csv", sensors)
    mapped = columns(sensors, "*1e-6")
    assert replay(capsys, str(run), "--from", str(log), "--map", mapped, "--map", "control==0") == {}


def test_other_settings_make_something_else_of_it(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = recorded(run)
    words = ("--from", str(micrometres(tmp_path / "log.csv", record)), "--map", columns(record, "*1e-6"))
    found = replay(capsys, str(run), *words, "--set", "midranging.valve.feed=1.0")
    assert max(found.values()) > 1e-6


@pytest.mark.slow
def test_a_stage_s_log_goes_through_the_loops_of_its_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = finished(tmp_path, "session.seconds=0.4")
    record = recorded(path)
    log = tmp_path / "log.parquet"
    write_recording(log, record)
    mapped = ",".join(f"{name}={name}" for name in record.names)
    assert set(replay(capsys, str(path), "--from", str(log), "--map", mapped).values()) == {0.0}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("relative=", "relativ="), "--map names relativ, must be a channel of the run: reference, .*; relative\\?"),
        (("control=col_control,", ""), "--map has no column for control, which controllers read"),
        (("fast=col_fast", "fast=col_fest"), "no channel 'col_fest'"),
        (("*1e-6,relative", "*1e-x,relative"), "whose '1e-x' must be a number"),
        (("control=col_control", "control"), "--map is 'control', must be CHANNEL=COLUMN"),
        (("control=", "fast="), "--map names fast twice"),
    ],
)
def test_what_does_not_fit_is_named(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], change: tuple[str, str], said: str
) -> None:
    record = recorded(run)
    log, mapped = micrometres(tmp_path / "log.csv", record), columns(record, "*1e-6")
    assert change[0] in mapped
    capsys.readouterr()
    assert main(["replay", str(run), "--from", str(log), "--map", mapped.replace(*change, 1)]) == 2
    assert_said(capsys, said)


def assert_said(capsys: pytest.CaptureFixture[str], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        raise ValueError(capsys.readouterr().err)


def test_another_rate_or_unit_than_the_run_s_is_refused(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = recorded(run)
    log = micrometres(tmp_path / "log.csv", record, rate=500.0)
    assert main(["replay", str(run), "--from", str(log), "--map", columns(record, "*1e-6")]) == 2
    assert_said(capsys, "500 samples/s, must be 250 as the run")
    in_micrometres = Recording(record.names, ("um",) * len(record.names), RATE, record.data)
    write_recording(tmp_path / "log.parquet", in_micrometres)
    mapped = ",".join(f"{name}={name}" for name in record.names)
    assert main(["replay", str(run), "--from", str(tmp_path / "log.parquet"), "--map", mapped]) == 2
    assert_said(capsys, "reference is in um, must be in m for reference: --map reference=reference\\*FACTOR")


@pytest.mark.parametrize("words", [("--map", "a=b"), ("--rate", "250"), ("--out", "made.csv")])
def test_what_goes_with_a_log_is_refused_without(
    run: Path, words: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(run), *words]) == 2
    assert_said(capsys, f"{words[0]} goes with --from LOG, which is not given")


def test_steps_that_another_program_has_recorded_are_taken(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run"
    assert main(["step", "--of", "stage", "--set", "midranging.session.lead=0.2", "--out", str(path)]) == 0
    (file,) = path.glob("*.wav")
    record = recording.read(file)
    write_recording(tmp_path / "log.parquet", record)
    mapped = ",".join(f"{name}={name}" for name in record.names)
    assert set(replay(capsys, str(path), "--from", str(tmp_path / "log.parquet"), "--map", mapped).values()) == {0.0}
