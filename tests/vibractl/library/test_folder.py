"""The library's folder: names stay inside it, nothing is lost by accident, and the nearest is found."""

from dataclasses import replace
from pathlib import Path

import pytest

from tests.vibractl.library.entries import entry_for
from tests.vibractl.linear_rig import linear_config
from vibractl.config import RigConfig
from vibractl.library.entry import EntryError
from vibractl.library.fit import misfit
from vibractl.library.folder import Library
from vibractl.reference import Reference
from vibractl.setup import reference_of


@pytest.fixture(scope="module")
def config() -> RigConfig:
    return linear_config()


@pytest.fixture(scope="module")
def reference(config: RigConfig) -> Reference:
    return reference_of(config)


@pytest.mark.parametrize("name", ["", ".", "..", "../a", "a/b", "/etc/a", ".hidden", "a b", "é", "a" * 81, "-x", "a\n"])
def test_a_name_stays_within_the_folder(tmp_path: Path, name: str) -> None:
    with pytest.raises(EntryError, match="must be 1 to 80 letters, digits"):
        Library(tmp_path / "library").write(name, entry_for(), False)
    assert list(tmp_path.iterdir()) == []


def test_an_entry_is_not_replaced_unless_asked_for(tmp_path: Path) -> None:
    library = Library(tmp_path / "deep" / "library")
    library.write("tank", entry_for(depth="1"), False)
    with pytest.raises(EntryError, match="has an entry 'tank' already; --force replaces it"):
        library.write("tank", entry_for(depth="2"), False)
    assert library.read("tank").tags == {"depth": "1"}
    library.write("tank", entry_for(depth="2"), True)
    assert library.read("tank").tags == {"depth": "2"}
    assert library.read("tank").name == "tank"


def test_an_unknown_entry_is_refused_with_what_there_is(tmp_path: Path) -> None:
    library = Library(tmp_path)
    with pytest.raises(EntryError, match="has no entry 'tank'; it holds nothing"):
        library.read("tank")
    library.write("sea", entry_for(), False)
    for act in (library.read, library.remove):
        with pytest.raises(EntryError, match="has no entry 'tank'; it holds sea"):
            act("tank")
    library.remove("sea")
    assert library.names == []


def test_a_library_that_is_a_file_or_below_one_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(EntryError, match="is a file, must be a folder"):
        Library(tmp_path / "file")
    with pytest.raises(OSError, match="Not a directory"):
        Library(tmp_path / "file" / "library").write("tank", entry_for(), False)


def test_the_nearest_is_the_one_whose_tags_are_and_then_the_latest(
    tmp_path: Path, config: RigConfig, reference: Reference
) -> None:
    library = Library(tmp_path)
    for name, depth, date in (("shallow", "5", "2026-03"), ("deep", "40", "2026-01"), ("deeper", "40", "2026-02")):
        library.write(name, entry_for(date=date, depth=depth), False)
    assert library.nearest(config, reference, {"depth": "6"}).name == "shallow"
    assert library.nearest(config, reference, {"depth": "38"}).name == "deeper"
    assert library.nearest(config, reference, {}).name == "shallow"
    found, refused = library.ranked(config, reference, {"depth": "5"})
    assert [(each.name, each.distance) for each in found] == [("shallow", 0.0), ("deeper", 1.0), ("deep", 1.0)]
    assert refused == {}


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (("rig.name=other",), "of rig 'simulated-vibrator', this rig is 'other'"),
        (("reference.signal=chirp:40:91:1",), "of reference chirp:40:90:1, this run's is chirp:40:91:1"),
        (("reference.amplitude=9",), "this run's is chirp:40:90:1 .of another amplitude, taper or rate"),
        (("learning.side=1",), "of channels and bins"),
        (("learning.band=[20.0,650.0]",), "of channels and bins"),
        (("audio.response_channels=[1,4]",), "of channels and bins"),
    ],
)
def test_what_does_not_fit_is_refused_with_the_reason(tmp_path: Path, overrides: tuple[str, ...], words: str) -> None:
    library, other = Library(tmp_path), linear_config(*overrides)
    library.write("tank", entry_for(), False)
    with pytest.raises(EntryError, match=words):
        library.fitting("tank", other, reference_of(other))
    with pytest.raises(EntryError, match=f"has no entry that fits: tank: .*{words}"):
        library.nearest(other, reference_of(other), {})


def test_a_damaged_entry_does_not_hide_a_good_one(tmp_path: Path, config: RigConfig, reference: Reference) -> None:
    library = Library(tmp_path)
    library.write("good", entry_for(), False)
    (tmp_path / "bad.h5").write_bytes(b"no HDF5")
    assert library.names == ["bad", "good"]
    assert library.nearest(config, reference, {}).name == "good"
    assert "not a readable entry" in library.ranked(config, reference, {})[1]["bad"]


def test_a_reference_is_known_by_its_samples_not_its_text(config: RigConfig, reference: Reference) -> None:
    entry = entry_for()
    assert misfit(entry, config, replace(reference, text="reference.wav")) == ""
    assert misfit(entry, config, replace(reference, signal=reference.signal * (1 + 1e-12))) == ""
    assert "of another amplitude" in misfit(entry, config, replace(reference, signal=reference.signal[::-1]))
