"""`calibrate identify --from`: drives and responses in files of their own, as SciPy writes them, pair by pair."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat, wavfile

from calibration.__main__ import main
from calibration.identification.recordings import from_pairs
from calibration.identification.workflow import identify_recordings
from ctlblocks.recording import Recording
from stagectl.models.model_file import read_model
from tests.calibration.identification.plain_scipy import RATE, off, response, white

FREQUENCY = np.linspace(10, 200, 100)
SAMPLES = (3_000, 1_500, 2_200)
FULL_SCALE = 32.0


def csv(file: Path, head: str, *columns: np.ndarray, mark: str = ",") -> None:
    data = np.column_stack(columns)
    np.savetxt(file, data, delimiter=mark, header=head.replace(",", mark), comments="", fmt="%.9g")


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write recordings of one plant as other programs do."""
    folder = tmp_path_factory.mktemp("lab")
    for number, samples in enumerate(SAMPLES):
        drive = white(number, samples) * ([1.0, 0.0], [0.0, 1.0], [1.0, 1.0])[number]
        heard = response(drive, seed=number)
        time = np.arange(samples) / RATE
        csv(folder / f"d{number}.csv", "t [s],u1 [V],u2 [V]", time, drive)
        csv(folder / f"r{number}.tsv", "t [s],y1 [m],y2 [m]", time, heard, mark="\t")
        wavfile.write(folder / f"d{number}.wav", RATE, (drive / FULL_SCALE).astype(np.float32))
        wavfile.write(folder / f"r{number}.wav", RATE, (heard / FULL_SCALE).astype(np.float32))
        savemat(folder / f"all{number}.mat", {"fs": float(RATE), "drive": drive, "response": heard})
    shift = np.column_stack((heard[:, 1], -heard[:, 0]))
    csv(folder / "turned.csv", "t [s],b [m],a [m]", time, shift)
    csv(folder / "slow.csv", "t [s],u1 [V],u2 [V]", 2 * time, drive)
    csv(folder / "silent-rate.csv", "u1 [V],u2 [V]", drive)
    csv(folder / "one.csv", "t [s],u1 [V]", time, drive[:, 0])
    csv(folder / "short.csv", "t [s],y1 [m],y2 [m]", time[:900], heard[:900])
    csv(folder / "feet.csv", "t [s],y1 [ft],y2 [ft]", time, heard)
    csv(folder / "cut.csv", "t [s],y1 [m],y2 [m]", time[:-200], heard[:-200])
    csv(folder / "alike.csv", "t [s],u1 [V],u2 [V]", time, drive[:, :1] * [1.0, 1.2])
    csv(folder / "near.csv", "t [s],u1 [V],u2 [V]", time, drive[:, :1] * [1.0, 1.2] + 0.012 * drive * [0.0, 1.0])
    csv(folder / "both.csv", "t [s],u1 [V],u2 [V],y1 [m],y2 [m]", time, drive, heard)
    csv(folder / "few.csv", "t [s],u1 [V],u2 [V],y1 [m],y2 [m]", time[:60], drive[:60], heard[:60])
    csv(folder / "other.csv", "t [s],y1 [m],y2 [m]", time, heard[::-1])
    holes = heard.copy()
    holes[700:720] = np.nan
    csv(folder / "holes.csv", "t [s],y1 [m],y2 [m]", time, holes)
    csv(folder / "all-holes.csv", "t [s],u1 [V],u2 [V],y1 [m],y2 [m]", time, drive, holes)
    lines = (folder / "all-holes.csv").read_text().replace("nan", "", 10)  # as spreadsheets write it
    (folder / "all-holes.csv").write_text(lines)
    spiky = heard.copy()
    spiky[::97, 0] += 40.0 * heard[:, 0].std()
    csv(folder / "spiky.csv", "t [s],u1 [V],u2 [V],y1 [m],y2 [m]", time, drive, spiky)
    return folder


@pytest.fixture
def folder(lab: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Go where the files are; what is written goes here."""
    monkeypatch.chdir(lab)
    return tmp_path


def identify(monkeypatch: pytest.MonkeyPatch, *words: str | Path) -> int:
    monkeypatch.setattr(sys, "argv", ["calibrate", "identify", *map(str, words)])
    return main()


CHANNELS = ("--inputs", "u1,u2", "--outputs", "y1,y2")


def test_where_samples_are_missing_a_recording_ends_and_another_one_begins(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = folder / "m.h5"
    assert identify(monkeypatch, "all-holes.csv", *CHANNELS, "--order", "8", "--out", out) == 0
    assert off(read_model(out, RATE).frequency_response(FREQUENCY), FREQUENCY) < 0.05
    assert read_model(out, RATE).provenance["recording"] == "all-holes.csv"
    assert "20 of 2200 samples are missing: 2180 in 2 stretches are used" in capsys.readouterr().out.replace("\n", " ")


def test_stretches_too_short_to_be_decimated_or_held_back_are_left_out(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = Path("both.csv").read_text().splitlines()
    text[2001] = ",".join([*text[2001].split(",")[:-1], ""])
    (folder / "tail.csv").write_text("\n".join(text))
    assert identify(monkeypatch, folder / "tail.csv", *CHANNELS, "--order", "8", "--decimate", "4") == 0
    assert "1 of 2200 samples is missing: 2000 in 1 stretch are used" in capsys.readouterr().out.replace("\n", " ")
    text[1::50] = [",".join([*line.split(",")[:-1], "nan"]) for line in text[1::50]]
    (folder / "many.csv").write_text("\n".join(text))
    assert identify(monkeypatch, folder / "many.csv", *CHANNELS) == 2
    assert "many.csv: 44 samples are missing, and between them there is no stretch of 88" in capsys.readouterr().err


def test_a_channel_that_has_no_sample_is_named(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "none.csv").write_text(
        "t [s],u1,u2,y1,y2\n" + "".join(f"{n},{n % 7},{n % 5},,{n % 3}\n" for n in range(300))
    )
    assert identify(monkeypatch, folder / "none.csv", *CHANNELS) == 2
    assert "none.csv: channel 'y1' has no sample" in capsys.readouterr().err


def test_outliers_are_replaced_before_the_rate_is_lowered(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong, low = [], FREQUENCY[FREQUENCY < 90]
    for words in ((), ("--outliers", "keep")):
        out = folder / f"m{len(wrong)}.h5"
        assert (
            identify(monkeypatch, "spiky.csv", *CHANNELS, "--order", "8", "--decimate", "4", "--out", out, *words) == 0
        )
        wrong.append(off(read_model(out).frequency_response(low), low))
    assert wrong[0] < 0.1
    assert wrong[1] > 2 * wrong[0]
    assert "23 of 2200 samples of output 1 are far off" in capsys.readouterr().out.replace("\n", " ")


FEW = "drive_1=u1,drive_2=u2,response_1=y1,response_2=y2"
THREE = tuple(word for number in range(3) for word in ("--from", f"d{number}.csv", f"r{number}.tsv"))


def test_three_recordings_of_several_lengths_give_one_model(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The first two drive one input each: only together they say everything."""
    out = folder / "m.h5"
    assert identify(monkeypatch, *THREE[:6], "--order", "8", "--out", out, "--json", folder / "m.json") == 0
    model = read_model(out, RATE, ["u1", "u2"], ["y1", "y2"])
    assert off(model.frequency_response(FREQUENCY), FREQUENCY) < 0.05
    assert (model.input_units, model.output_units) == (("V", "V"), ("m", "m"))
    assert model.provenance["recording"] == "d0.csv + r0.tsv, d1.csv + r1.tsv"
    assert model.provenance["samples"] == str(round(0.7 * 3_000) + round(0.7 * 1_500))
    figures = json.loads((folder / "m.json").read_text())
    assert figures["nearly_collinear"] == figures["notes"] == []
    assert figures["recordings"] == ["d0.csv + r0.tsv", "d1.csv + r1.tsv"]
    assert min(each["free_run_nrmse"] for each in figures["held_back"]["outputs"].values()) > 95
    printed = capsys.readouterr().out
    assert "1350validation samples" in printed
    assert "nearly go together" not in printed


@pytest.mark.usefixtures("folder")
def test_sounds_and_matrices_hold_what_tables_hold() -> None:
    names = {name: name for name in ("drive_1", "drive_2", "response_1", "response_2")}
    table = from_pairs([Path("d2.csv")], [Path("r2.tsv")], {}, None).recordings[0]
    matrix = from_pairs([Path("all2.mat")], [Path("all2.mat")], names, None).recordings[0]
    sound = from_pairs([Path("d2.wav")], [Path("r2.wav")], {}, None).recordings[0]
    assert table.rate == matrix.rate == sound.rate == RATE
    assert sound.names == tuple(names)  # a sound names none
    np.testing.assert_allclose(matrix.data, table.data, rtol=1e-8)
    np.testing.assert_allclose(FULL_SCALE * sound.data, table.data, rtol=1e-6, atol=1e-6)


@pytest.mark.usefixtures("folder")
def test_a_map_says_order_and_sign() -> None:
    given = {"response_1": "-a", "response_2": "b"}
    straight = from_pairs([Path("d2.csv")], [Path("r2.tsv")], {}, None)
    mapped = from_pairs([Path("d2.csv")], [Path("turned.csv")], given, None)
    np.testing.assert_array_equal(mapped.recordings[0].data, straight.recordings[0].data)
    assert (mapped.inputs, mapped.recordings[0].names) == (2, ("u1", "u2", "a", "b"))
    by_number = from_pairs([Path("both.csv")], [Path("both.csv")], _numbers("drive_1=2,drive_2=3"), None)
    np.testing.assert_array_equal(by_number.recordings[0].data, straight.recordings[0].data)


def _numbers(drives: str) -> dict[str, str]:
    pairs = [each.split("=") for each in f"{drives},response_1=4,response_2=5".split(",")]
    return dict(pairs)


def test_no_sample_of_one_recording_predicts_the_next() -> None:
    """Two recordings that begin in motion: joined to one, their seam is a step that no model explains."""
    parts = []
    for seed in range(2):
        drive = white(seed, 2_000)
        heard = response(drive, seed=seed)[500:]  # begins in motion
        parts.append(np.column_stack((drive[500:], heard)))
    names, units = ("u1", "u2", "y1", "y2"), ("1",) * 4
    apart = [Recording(names, units, float(RATE), each) for each in parts]
    joined = [Recording(names, units, float(RATE), np.concatenate(parts))]
    errors = []
    for records in (apart, joined):
        model = identify_recordings(records, 2, order=8, horizon=15).model
        errors.append(off(model.frequency_response(FREQUENCY), FREQUENCY))
    assert errors[0] < 0.7 * errors[1]


@pytest.mark.slow
def test_decimated_recordings_give_a_model_at_the_lower_rate(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fast = 8 * RATE
    drive = white(11, 40_000)
    wavfile.write(folder / "d.wav", fast, (drive / FULL_SCALE).astype(np.float32))
    heard = response(drive, seed=11, rate=fast)
    wavfile.write(folder / "r.wav", fast, (heard / FULL_SCALE).astype(np.float32))
    files = "--from", folder / "d.wav", folder / "r.wav"
    assert identify(monkeypatch, *files, "--decimate", "8", "--order", "8", "--out", folder / "m.h5") == 0
    model = read_model(folder / "m.h5", RATE)
    assert off(model.frequency_response(FREQUENCY), FREQUENCY, fast) < 0.05
    assert (model.provenance["decimated"], model.provenance["recorded_rate"]) == ("8", "8000")
    said = "decimated by 8 to 1000 samples/s: 192 samples at either end of the recording are left out"
    assert said in capsys.readouterr().out
    assert said[1:] in (folder / "m.html").read_text()


def test_inputs_that_nearly_go_together_are_warned_of(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--from", "near.csv", "r2.tsv", "--order", "4", "--json", folder / "m.json")
    assert identify(monkeypatch, *words) == 0
    assert "warning: inputs nearly go together at " in capsys.readouterr().out
    (band,) = json.loads((folder / "m.json").read_text())["nearly_collinear"]
    assert band["inputs"] == ["u1", "u2"]


@pytest.mark.usefixtures("folder")
def test_files_that_do_not_belong_together_are_warned_of(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert identify(monkeypatch, "--from", "d2.csv", "other.csv", "--order", "4", "--horizon", "20") == 0
    assert "warning: the free run explains " in capsys.readouterr().out
    assert identify(monkeypatch, "--from", "d2.csv", "r2.tsv", "--order", "8", "--horizon", "20") == 0
    assert "warning" not in capsys.readouterr().out


@pytest.mark.usefixtures("folder")
def test_a_longer_file_is_used_as_far_as_the_other_reaches() -> None:
    found = from_pairs([Path("d2.csv")], [Path("cut.csv")], {}, None)
    assert len(found.recordings[0].data) == 2_000
    assert found.notes == ("d2.csv: the last 200 samples have none beside them and are left out",)


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("--from", "d0.csv"), "--from has 1 drives and 0 responses, must be a pair each time"),
        (("--from", "d0.csv", "none.csv"), "none.csv: there is no such file"),
        ((*THREE[:6], "--from", "slow.csv", "r2.tsv"), "r2.tsv: 1000 samples/s, must be 500, as slow.csv has"),
        ((*THREE[:3], "--from", "slow.csv", "slow.csv"), "slow.csv: has channels u1, u2, which are drives and which"),
        ((*THREE[:3], "--from", "one.csv", "r2.tsv"), "one.csv: 1 drives, must be 2, as d0.csv has"),
        ((*THREE[:3], "--from", "d2.csv", "one.csv"), "one.csv: 3 channels, must be 4, as d0.csv has"),
        ((*THREE[:3], "--from", "d2.csv", "feet.csv"), "'y1' is in ft, must be in m, as d0.csv has"),
        (("--from", "d2.csv", "short.csv"), "short.csv: 900 samples, d2.csv has 2200, must be nearly as many"),
        (("--from", "silent-rate.csv", "r2.tsv"), "silent-rate.csv: does not say its rate"),
        ((*THREE[:3], "--rate", "500"), "d0.csv: 1000 samples/s, --rate says 500"),
        (("--from", "d2.csv", "holes.csv"), "holes.csv: "),
        (("--from", "alike.csv", "r2.tsv"), "inputs u1 and u2 are not distinguishable"),
        ((*THREE[:3], "--inputs", "u1"), "--inputs or --outputs and --from are given, must be one of them"),
        ((*THREE[:3], "--map", "drive_2=u1"), "--map has drive_2, must have drive_1: numbers from 1 on"),
        ((*THREE[:3], "--map", "drive_1=z"), "d0.csv: no channel 'z'; there are t, u1, u2"),
        ((*THREE[:3], "--map", "monitor_1=u1"), "--map has monitor_1, must have drive_N and response_N"),
        (("both.csv", "--inputs", "u1", "--outputs", "y1", "--map", "drive_1=u1"), "--map is given without --from"),
        (("d0.csv", "r0.tsv", "--inputs", "u1", "--outputs", "y1"), "2 files are given, must be one"),
        (("--inputs", "u1", "--outputs", "y1"), "0 files are given, must be one"),
        (("both.csv", "--outputs", "y1"), "--inputs is not given, must name channels of DATA"),
        ((*THREE, "--decimate", "40"), "--decimate is 40: 27 of the 3000 samples of d0.csv + r0.tsv would be left"),
        (
            (*THREE[:3], "--from", "few.csv", "few.csv", "--map", FEW),
            "recording 2 has 60 samples, of which 18 would be",
        ),
        ((*THREE, "--decimate", "0"), "--decimate is 0, must be a whole number >= 1"),
        ((*THREE, "--out", "d0.h5x"), "must be '.h5'"),
    ],
)
def test_a_fault_is_one_line_and_nothing_is_written(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    complaint: str,
) -> None:
    there = sorted(Path().iterdir())
    out = () if "--out" in words else ("--out", folder / "m.h5")
    assert identify(monkeypatch, *words, *out) == 2
    said = [line for line in capsys.readouterr().err.splitlines() if not line.startswith("identifying")]
    assert len(said) == 1
    assert complaint in said[0]
    assert sorted(Path().iterdir()) == there
    assert not list(folder.iterdir())
