from dataclasses import replace
from pathlib import Path

import numpy as np

from ctlblocks import recording
from vibractl.capture import Capture, Discarded
from vibractl.config import Audio, RigConfig
from vibractl.shot_file import far_field_of, keep_discarded, recording_of, split

CAPTURE = Capture(
    emitted=np.ones((4, 2), np.float32),
    response=np.full((4, 2), 2.0, np.float32),
    far_field=np.zeros((4, 0), np.float32),
    loopback=np.zeros(4, np.float32),
    delay=61.25, residual=0.01, quality=0.999, input_xruns=1, output_xruns=0, late=0,
)  # fmt: skip


def test_discarded_recordings_are_kept_whole_each_under_its_own_name(tmp_path: Path) -> None:
    config = RigConfig()
    kept = [keep_discarded(tmp_path / "new", "0007", Discarded(1, "xruns", CAPTURE), config) for _ in range(2)]
    assert kept[0] != kept[1]
    for path in kept:
        found = recording.read(path)
        assert found.names == ("drive_1", "drive_2", "response_1", "response_2", "loopback")
        np.testing.assert_array_equal(found.select(["response_2"]).data[:, 0], CAPTURE.response[:, 1])
        assert found.provenance["delay"] == "61.25"
        assert found.provenance["input_xruns"] == "1"


def test_a_response_that_no_recording_can_hold_is_kept_as_numbers(tmp_path: Path) -> None:
    broken = CAPTURE.response.copy()
    broken[2, 1] = np.nan
    path = keep_discarded(tmp_path, "batch", Discarded(2, "not finite", replace(CAPTURE, response=broken)), RigConfig())
    assert path.suffix == ".npy"
    np.testing.assert_array_equal(np.load(path), np.column_stack((broken, CAPTURE.loopback)))


def test_a_cable_that_no_recording_can_hold_is_kept_as_numbers(tmp_path: Path) -> None:
    cable = np.full_like(CAPTURE.loopback, np.inf)
    path = keep_discarded(tmp_path, "batch", Discarded(2, "not finite", replace(CAPTURE, loopback=cable)), RigConfig())
    np.testing.assert_array_equal(np.load(path)[:, -1], cable)


def test_hydrophones_are_recorded_in_pascal_beside_the_responses() -> None:
    config = RigConfig(audio=Audio(far_field_channels=(4, 5)))
    heard = np.arange(8, dtype=np.float32).reshape(4, 2)
    record = recording_of(replace(CAPTURE, far_field=heard), config)
    assert record.names[-3:] == ("far_field_1", "far_field_2", "loopback")
    assert record.units[-3:] == ("Pa", "Pa", "1")
    np.testing.assert_array_equal(far_field_of(record, config), heard)
    np.testing.assert_array_equal(split(record, config)[1], CAPTURE.response)


def test_a_recording_without_hydrophones_has_a_far_field_without_columns() -> None:
    assert far_field_of(recording_of(CAPTURE, RigConfig()), RigConfig()).shape == (4, 0)
