"""An entry of the library: it is read as it was written, and nothing damaged is believed."""

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from rigkit import atomic
from rigkit.sealed_file import seal
from tests.vibractl.library.entries import entry_for
from vibractl.library.entry import UNITS, Entry, EntryError, read_entry, write_entry


@pytest.fixture(scope="module")
def entry() -> Entry:
    return entry_for(depth="10", place="tank")


def test_it_is_read_as_it_was_written(tmp_path: Path, entry: Entry) -> None:
    write_entry(tmp_path / "a.h5", entry)
    read = read_entry(tmp_path / "a.h5")
    for name in UNITS:
        np.testing.assert_array_equal(getattr(read, name), getattr(entry, name))
    assert read.about == entry.about
    assert read.tags == {"depth": "10", "place": "tank"}
    np.testing.assert_array_equal(read.response, entry.reference)


def test_every_part_has_its_unit(tmp_path: Path, entry: Entry) -> None:
    write_entry(tmp_path / "a.h5", entry)
    with h5py.File(tmp_path / "a.h5") as file:
        assert {name: file[name].attrs["unit"] for name in UNITS} == UNITS
    write_entry(tmp_path / "a.h5", replace(entry, about={**entry.about, "unit": "Pa"}))
    with h5py.File(tmp_path / "a.h5") as file:
        assert (file["error"].attrs["unit"], file["model"].attrs["unit"]) == ("Pa s", "Pa/V")


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"drive": np.zeros((3, 2), complex)}, "drive has shape"),
        ({"error": np.zeros((0, 2), complex)}, "error has shape"),
        ({"model": np.zeros(4, complex)}, "frequency has shape"),
        ({"frequency": None}, "must rise"),
        ({"reference": np.nan}, "reference is not finite at bin 0"),
        ({"drive": 0.0}, "the drive is silent"),
        ({"drive": "text"}, "must hold numbers"),
        ({"variance": 1j}, "must hold numbers"),
        ({"about": {"name": "kept"}}, "does not say its rig, wiring"),
    ],
)
def test_what_is_no_entry_is_refused(entry: Entry, parts: dict[str, object], words: str) -> None:
    (name, value), changed = next(iter(parts.items())), dict(parts)
    if value is None:
        changed[name] = entry.frequency[::-1]
    elif isinstance(value, str):
        changed[name] = np.full(entry.drive.shape, value)
    elif not isinstance(value, np.ndarray | dict):
        changed[name] = value * np.ones(getattr(entry, name).shape)
    with pytest.raises(EntryError, match=words):
        replace(entry, **changed)  # type: ignore[arg-type]


@pytest.mark.parametrize("cut", [0, 100, 3_000, -1_000])
def test_a_file_cut_short_is_refused_by_name(tmp_path: Path, entry: Entry, cut: int) -> None:
    path = tmp_path / "a.h5"
    write_entry(path, entry)
    path.write_bytes(path.read_bytes()[:cut])
    with pytest.raises(EntryError, match=r"a\.h5: not a readable entry"):
        read_entry(path)


def test_another_format_and_a_file_that_lacks_a_part_are_refused(tmp_path: Path, entry: Entry) -> None:
    write_entry(tmp_path / "a.h5", entry)
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        del file["variance"]
    seal(tmp_path / "a.h5")
    with pytest.raises(EntryError, match="not a readable entry"):
        read_entry(tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        file.attrs["format"] = "vibrostage transfer matrix 1"
    seal(tmp_path / "a.h5")
    with pytest.raises(EntryError, match="format is 'vibrostage transfer matrix 1', must be"):
        read_entry(tmp_path / "a.h5")
    with pytest.raises(EntryError, match="there is no such entry"):
        read_entry(tmp_path / "b.h5")


def test_a_write_that_fails_leaves_what_was_there(
    tmp_path: Path, entry: Entry, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.h5"
    write_entry(path, entry)
    before = path.read_bytes()

    def fail(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(atomic, "to_disk", fail)
    with pytest.raises(OSError, match="disk full"):
        write_entry(path, entry.named("other"))
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
