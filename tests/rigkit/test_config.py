"""Rig files as a person writes them: what is accepted, and what is said of what is not."""

from pathlib import Path

import pytest

from rigkit.config import ConfigError, load
from tests.rigkit.rig_file import RigFile


def refusal(text: str, tmp_path: Path) -> str:
    path = tmp_path / "rig.toml"
    path.write_text(text)
    with pytest.raises(ConfigError) as fault:
        load(path, RigFile)
    message = str(fault.value)
    assert "\n" not in message
    assert message.startswith(f"{path}: ")
    return message.removeprefix(f"{path}: ")


def override_refusal(*overrides: str) -> str:
    with pytest.raises(ConfigError) as fault:
        load(None, RigFile, overrides)
    assert "\n" not in str(fault.value)
    return str(fault.value)


def test_no_file_gives_the_defaults() -> None:
    assert load(None, RigFile) == RigFile()


def test_arrays_become_tuples_and_whole_numbers_become_floats_where_a_float_is_wanted(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text("[device]\nchannels = [3, 4]\nband = [20, 600]\ngain = 3\n")
    device = load(path, RigFile).device
    assert device.channels == (3, 4)
    assert (device.band, device.gain) == ((20.0, 600.0), 3.0)
    assert all(isinstance(number, float) for number in (*device.band, device.gain))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[device]\nrate = 3", "device.rate is 3, must be >= 8000 and <= 192000 samples/s"),
        ("[device]\nrate = 44100.5", "device.rate is 44100.5, must be a whole number >= 8000 and <= 192000 samples/s"),
        ("[device]\ngain = 10", "device.gain is 10, must be > 0 and < 10 V"),
        ("[device]\ngain = true", "device.gain is true, must be a number > 0 and < 10 V"),
        ("[device]\ngain = nan", "device.gain is nan, must be finite"),
        ("[device]\ngain = 1e999", "device.gain is inf, must be finite"),
        ('[device]\nname = ""', 'device.name is "", must be text, not empty, at most 20 long'),
        ("[device]\nchannels = []", "device.channels is [], must be a list of whole numbers, not empty"),
        ('[device]\nchannels = [1, "a"]', 'device.channels is [1, "a"], must be a list of whole numbers, not empty'),
        ("[device]\nband = [1]", "device.band is [1], must be a list of 2 numbers in Hz"),
        ("[device]\nband = [9, 8]", "device.band is 9 to 8 Hz, must rise"),
        ('[device]\nmode = "quick"', 'device.mode is "quick", must be "fast" or "slow"'),
        ("[device]\nstep = 2", "device.step is 2, must be 1 or 4"),
        ("[device]\nisolated = 1", "device.isolated is 1, must be true or false"),
        ("device = 3", "device is 3, must be a table"),
        ("[device]\nfilter = 3", "device.filter is 3, must be a table"),
        ("[device]\noptions = 3", "device.options is 3, must be a table"),
        ("[device.filter]\ncorner = 0", "device.filter.corner is 0, must be > 0 and <= 10000 Hz"),
        (
            '[device]\nstream = "x"',
            r'device.stream is "x", must be text, matching ^[\w.]+:\w+$ (module:Class of the stream)',
        ),
    ],
)
def test_a_wrong_value_is_told_with_what_is_allowed(text: str, message: str, tmp_path: Path) -> None:
    assert refusal(text, tmp_path) == message


def test_an_unknown_key_suggests_the_nearest_name(tmp_path: Path) -> None:
    assert refusal("[device]\nrte = 4", tmp_path) == "device.rte is 4, but [device] has no rte; did you mean rate?"


def test_an_unknown_table_suggests_the_nearest_name(tmp_path: Path) -> None:
    assert refusal("[devise]", tmp_path) == "devise is {}, but a rig file has no devise; did you mean device?"


def test_a_key_that_resembles_none_lists_those_there_are(tmp_path: Path) -> None:
    message = refusal("[device.filter]\nxyz = 4", tmp_path)
    assert message == "device.filter.xyz is 4, but [device.filter] has no xyz; there are corner"


def test_of_several_faults_the_first_is_told_and_the_others_counted(tmp_path: Path) -> None:
    message = refusal('[device]\nrate = 3\nstep = 5\nmode = "x"', tmp_path)
    assert message.endswith("must be >= 8000 and <= 192000 samples/s (and 2 more)")


def test_a_file_in_which_little_is_right_may_be_that_of_another_program(tmp_path: Path) -> None:
    message = refusal("[device]\n" + "".join(f"other_{n} = {n}\n" for n in range(12)), tmp_path)
    assert message.endswith("(and 11 more: is it the file of another program?)")


def test_a_long_value_is_shortened(tmp_path: Path) -> None:
    message = refusal(f"[device]\nrate = {list(range(1000))}", tmp_path)
    assert message.startswith("device.rate is [0, 1, 2,")
    assert len(message) < 150


def test_an_override_goes_over_the_file(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text("[device]\nrate = 48000\ngain = 2.0\n")
    device = load(path, RigFile, ["device.rate=96000"]).device
    assert (device.rate, device.gain) == (96_000, 2.0)


@pytest.mark.parametrize(
    ("override", "key", "value"),
    [
        ("device.rate=48_000", "rate", 48_000),
        (" device . gain = 3 ", "gain", 3.0),
        ("device.name=hw:0", "name", "hw:0"),
        ('device.name="a=b"', "name", "a=b"),
        ("device.name=3", "name", "3"),
        ("device.channels=[2]", "channels", (2,)),
        ("device.isolated=false", "isolated", False),
        ("device.options.noise=-80", "options", {"noise": -80}),
        ("device.options={noise = -80.5, deep = {a = [1]}}", "options", {"noise": -80.5, "deep": {"a": [1]}}),
        ("device.options.deep.gain=word", "options", {"deep": {"gain": "word"}}),
    ],
)
def test_an_override_is_toml_or_a_bare_word(override: str, key: str, value: object) -> None:
    assert getattr(load(None, RigFile, [override]).device, key) == value


def test_the_last_override_of_a_key_holds() -> None:
    assert load(None, RigFile, ["device.rate=48000", "device.rate=96000"]).device.rate == 96_000


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["device.rate=3"], "--set device.rate=3: device.rate is 3, must be >= 8000 and <= 192000 samples/s"),
        (["device.gain=nan"], "--set device.gain=nan: device.gain is nan, must be finite"),
        (["device.rate"], "--set 'device.rate': must be table.key=value on one line"),
        (["a b=3"], "--set a b=3: 'a b' is no key, must be such as table.key"),
        (["device.options=[1"], "--set device.options=[1: not TOML: Unclosed array (at end of document)"),
        (["device.rate=1\nx=2"], r"--set 'device.rate=1\nx=2': must be table.key=value on one line"),
        (["\udcff.x=3"], r"--set '\udcff.x=3': must be table.key=value on one line"),
        (["device.rate=9000", "device.rate.x=3"], "--set device.rate.x=3: device.rate is 9000, not a table"),
        (["device.options.day=1979-05-27"], "--set device.options.day=1979-05-27: device.options.day is 1979-05-27, "
         "must be text, a number, true or false"),
        (["device.band=[9, 8]"], "--set device.band=[9, 8]: device.band is 9 to 8 Hz, must rise"),
    ],
)  # fmt: skip
def test_a_wrong_override_is_told_as_such(overrides: list[str], message: str) -> None:
    assert override_refusal(*overrides) == message


def test_a_fault_in_the_file_is_not_blamed_on_an_override(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text("[device]\nrate = 3\n")
    with pytest.raises(ConfigError, match=r"rig.toml: device.rate is 3"):
        load(path, RigFile, ["device.gain=2"])


def test_a_fault_in_an_override_is_not_blamed_on_the_file(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text("[device]\nrate = 48000\n")
    with pytest.raises(ConfigError, match=r"^--set device.rate=3: device.rate is 3"):
        load(path, RigFile, ["device.gain=2", "device.rate=3"])


def test_a_fault_between_keys_names_every_source_of_their_table(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text("[device]\nband = [30, 40]\n")
    with pytest.raises(ConfigError) as fault:
        load(path, RigFile, ["device.gain=2", "device.band=[9, 8]"])
    assert str(fault.value) == (
        f"{path} --set device.gain=2 --set device.band=[9, 8]: device.band is 9 to 8 Hz, must rise"
    )
