import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from calibration.experiment import Plan, RawFolder, RawFolderError
from rigkit.lock import FolderInUseError


@dataclass(frozen=True)
class Noise:
    """A batch of seeded noise."""

    seed: int
    samples: int = 400

    def drive(self) -> np.ndarray:
        return np.random.default_rng(self.seed).standard_normal((self.samples, 1))


PLAN = Plan(
    "noise", {"level": "1.0", "seeds": "3"}, 1000.0, [("force", "N")], [("travel", "m")], [*map(Noise, range(3))]
)


def double(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return drive.astype(np.float32), 2 * drive.astype(np.float32)


def counting() -> tuple[Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], list[int]]:
    played: list[int] = []

    def emit(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        played.append(len(drive))
        return double(drive)

    return emit, played


def test_every_batch_is_on_the_disk_before_anything_is_computed_from_it(tmp_path: Path) -> None:
    with RawFolder(tmp_path / "raw") as raw:
        for number, (batch, record) in enumerate(raw.record(PLAN, double)):
            assert raw.file(PLAN, number).is_file()
            assert np.array_equal(record.data[:, :1], batch.drive().astype(np.float32))
            assert np.array_equal(record.data[:, 1], 2 * record.data[:, 0])
            assert (record.names, record.units) == (("force", "travel"), ("N", "m"))
            assert record.provenance["fingerprint"] == PLAN.fingerprint
    assert number == 2


def test_what_is_recorded_is_not_emitted_again(tmp_path: Path) -> None:
    emit, played = counting()
    with RawFolder(tmp_path) as raw:
        first = raw.record(PLAN, emit)
        next(first)
        next(first)
    with RawFolder(tmp_path) as raw:
        assert raw.recorded(PLAN) == pytest.approx(0.8)
        assert len(list(raw.record(PLAN, emit))) == 3
    assert len(played) == 3


def test_a_failing_emission_leaves_what_was_recorded(tmp_path: Path) -> None:
    def fail(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        raise OSError(f"the cable is out, {len(drive)} samples")

    with RawFolder(tmp_path) as raw:
        next(raw.record(PLAN, double))
        with pytest.raises(OSError, match="cable"):
            list(raw.record(PLAN, fail))
        assert [path.name for path in sorted(tmp_path.glob("*.wav"))] == ["noise-000.wav"]


def test_other_settings_in_the_same_folder_are_refused_with_what_differs(tmp_path: Path) -> None:
    other = replace(PLAN, settings={"level": "2.0", "seeds": "4"})
    with RawFolder(tmp_path) as raw:
        next(raw.record(PLAN, double))
        with pytest.raises(RawFolderError, match=r"level = 1\.0, now it is 2\.0 \(and 1 more\)"):
            next(raw.record(other, double))


def test_a_recording_of_another_experiment_is_refused(tmp_path: Path) -> None:
    other = replace(PLAN, settings={"level": "2.0"})
    with RawFolder(tmp_path / "a") as a, RawFolder(tmp_path / "b") as b:
        next(a.record(PLAN, double))
        next(b.record(other, double))
        a.file(PLAN, 0).replace(b.file(other, 0))
        with pytest.raises(RawFolderError, match="is not batch 0 of this experiment"):
            next(b.record(other, double))


def test_a_damaged_plan_is_refused(tmp_path: Path) -> None:
    (tmp_path / "noise.json").write_text("[")
    with RawFolder(tmp_path) as raw, pytest.raises(RawFolderError, match=r"noise\.json: not JSON"):
        next(raw.record(PLAN, double))


def test_a_folder_that_another_process_works_in_is_refused(tmp_path: Path) -> None:
    with RawFolder(tmp_path), pytest.raises(FolderInUseError):
        RawFolder(tmp_path).__enter__()


def test_a_folder_in_which_nothing_was_recorded_is_taken_away_again(tmp_path: Path) -> None:
    def fail(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        raise OSError(f"no device, {len(drive)} samples")

    with pytest.raises(OSError, match="no device"), RawFolder(tmp_path / "raw") as raw:
        list(raw.record(PLAN, fail))
    assert list(tmp_path.iterdir()) == []


def test_the_files_of_killed_writes_are_swept_up(tmp_path: Path) -> None:
    for name in (".noise-001.wav.0a1b2c3d.tmp", ".noise.0a1b2c3d.tmp.json"):
        (tmp_path / name).write_bytes(b"half")
    with RawFolder(tmp_path) as raw:
        assert len(list(raw.record(PLAN, double))) == 3
    assert not list(tmp_path.glob("*.tmp*"))
    assert json.loads((tmp_path / "noise.json").read_text()) == dict(PLAN.settings)
