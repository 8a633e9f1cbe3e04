"""What rigkit writes, it reads back: the example, and the values of a run bit for bit."""

import struct
from pathlib import Path
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rigkit.config import dump, example, load
from rigkit.config_text import WIDTH
from tests.rigkit.rig_file import Device, RigFile

numbers = st.floats(allow_nan=False, allow_infinity=False)
plain = st.one_of(st.text(), st.booleans(), st.integers(-(2**70), 2**70), numbers)
tables = st.recursive(
    st.dictionaries(st.text(), plain, max_size=4),
    lambda inner: st.dictionaries(st.text(), st.one_of(plain, st.lists(plain, max_size=4), inner), max_size=4),
    max_leaves=8,
)


def read_back(text: str, folder: Path) -> RigFile:
    (folder / "rig.toml").write_bytes(text.encode())
    return load(folder / "rig.toml", RigFile)


def exactly(value: Any) -> Any:
    """Tell 1, 1.0 and True apart, and 0.0 and -0.0; the order of keys does not count."""
    if isinstance(value, dict):
        return {key: exactly(item) for key, item in value.items()}
    return [exactly(item) for item in value] if isinstance(value, list) else repr(value)


def test_the_example_holds_the_defaults(tmp_path: Path) -> None:
    assert read_back(example(RigFile), tmp_path) == RigFile()


def test_the_example_explains_every_key() -> None:
    text = example(RigFile)
    for line in (
        "[device]",
        "rate     = 44100",
        "# sample rate; >= 8000 and <= 192000 samples/s; default 44100",
        '# how it plays; "fast" or "slow"; default "fast"',
        "# band; in Hz; default [15.0, 650.0]",
        "# channels, counted from 1; not empty; default [1, 2]",
        "# in a process of its own; true or false; default true",
        "# The device that plays.",
        "[device.filter]",
        "[device.options]",
    ):
        assert line in text
    assert "for programmers" not in text


def test_the_example_fits_its_width_and_aligns_its_comments() -> None:
    lines = example(RigFile).splitlines()
    assert max(map(len, lines)) <= WIDTH
    table = lines[lines.index("[device]") + 1 : lines.index("# A filter in a table of its own.") - 1]
    assert len({line.index("  # ") for line in table}) == 1


@given(st.floats(0, 10, exclude_min=True, exclude_max=True), st.tuples(numbers, numbers).map(sorted).map(tuple))
def test_every_float_is_read_back_to_its_last_bit(
    tmp_path_factory: Any, gain: float, band: tuple[float, float]
) -> None:
    assume(band[0] < band[1])
    config = RigFile(device=Device(gain=gain, band=band))
    device = read_back(dump(config), tmp_path_factory.mktemp("config")).device
    assert struct.pack("3d", device.gain, *device.band) == struct.pack("3d", gain, *band)


@given(tables)
def test_any_table_of_options_is_read_back(tmp_path_factory: Any, options: dict[str, Any]) -> None:
    config = RigFile(device=Device(options=options))
    back = read_back(dump(config), tmp_path_factory.mktemp("config"))
    assert exactly(back.device.options) == exactly(options)


def test_what_toml_cannot_hold_is_refused_by_value() -> None:
    with pytest.raises(TypeError, match="a setting is None, must be text, a number"):
        dump(RigFile(device=Device(options={"a": None})))
    with pytest.raises(ValueError, match="a setting is nan, must be finite"):
        dump(RigFile(device=Device(options={"a": float("nan")})))
