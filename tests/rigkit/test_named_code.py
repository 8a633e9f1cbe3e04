"""Code that a rig file names is looked at before any of it is called, and a daemon imports only what it knows."""

import re
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from firmware_sim.laboratory import plant_block
from rigkit.config import ConfigError, Section
from rigkit.named_code import KnownCode, named_block, named_class, names_in
from rigkit.relay.bus import RelayBus
from rigkit.relay.config import Relay
from stagectl.config import StageConfig
from stagectl.link.bus import open_bus
from stagectl.link.config import Link
from stagectl.robot.config import CellConfig
from tests.contract.source_tree import PACKAGES, ROOT, sources
from tests.rigkit import trap
from vibractl.audio_stream import AudioError, open_stream
from vibractl.config import Audio, RigConfig

TRAPS = ("tests.rigkit.trap:Trap", "tests.rigkit.trap:trap", "subprocess:Popen", "os:system")
DOORS: dict[str, Callable[[str], object]] = {
    "a block": lambda name: named_block(name, {"args": ["touch", "/nowhere/at/all"]}),
    "simulator.plant": lambda name: plant_block(name, {"args": ["true"]}),
    "audio.stream": lambda name: open_stream(RigConfig(audio=Audio(stream=name)), print),
    "link.bus": lambda name: open_bus(Link(bus=name, channel="true", options={"args": ["true"]})),
    "relay.bus": lambda name: RelayBus(Relay(bus=name, channel="true", options={"args": ["true"]})),
}


@pytest.mark.parametrize("name", TRAPS)
@pytest.mark.parametrize("door", DOORS)
def test_what_is_no_such_class_is_refused_and_never_called(
    door: str, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(*_: object, **__: object) -> None:
        raise AssertionError("something was run")

    for known in ("subprocess.Popen.__init__", "os.system"):
        monkeypatch.setattr(known, run)
    trap.called.clear()
    with pytest.raises((ValueError, AudioError), match=rf"{name} is .*, must be the class of a"):
        DOORS[door](name)
    assert trap.called == []


def test_nothing_else_finds_code_by_a_name() -> None:
    """Whoever resolves a name by itself does so for one of its own, not of a file."""
    own = {"rigkit/named_code.py", "rigkit/config_reference.py", "rigkit/service/daemon_command.py"}
    own |= {"rigkit/service/web_process.py", "vibractl/daemon/rig.py", "stagectl/daemon/stage/rig.py"}
    own |= {
        "rigkit/config_options.py",
        "stagectl/daemon/cell/rig.py",
        "stagectl/daemon/cell/procedures.py",
        "stagectl/experiments/kinds.py",
        "rigkit/code_name.py",
        "rigkit/issue_file.py",
        "rigkit/posix.py",
        "firmware_sim/population/__init__.py",
        "firmware_sim/population/kinds.py",
        "rigkit/export/optional.py",
        "rigkit/program.py",
        "vibractl/devices_command.py",
        "vibrostage/sysid.py",
    }
    finds = re.compile(r"\b(resolve|import_module|__import__)\((?!\))")
    users = {str(file.relative_to(ROOT)) for file in sources(*PACKAGES) if finds.search(file.read_text())}
    assert users == own


def test_a_class_is_returned_and_not_made() -> None:
    assert named_class("tests.rigkit.trap:Trap", "a trap", lambda found: found is trap.Trap) is trap.Trap


@pytest.mark.parametrize("model", [RigConfig, StageConfig, CellConfig])
def test_every_key_that_names_code_is_known_to_be_one(model: type[Section]) -> None:
    """By its default, which is of that form."""
    form = re.compile(r"[a-z_][\w.]*:[A-Z]\w*")
    named = names_in(model())
    assert {key: text for key, text in _texts(model(), "") if form.fullmatch(text)} == named
    assert named


def _texts(config: Section, prefix: str) -> list[tuple[str, str]]:
    found = []
    for key in type(config).model_fields:
        value = getattr(config, key)
        if isinstance(value, Section):
            found += _texts(value, f"{prefix}{key}.")
        elif isinstance(value, str):
            found.append((f"{prefix}{key}", value))
    return found


def test_a_daemon_knows_what_it_was_started_with_and_the_defaults() -> None:
    known = KnownCode(RigConfig(audio=Audio(stream="sounddevice:Stream")))
    known.refuse_other(RigConfig())
    known.refuse_other(RigConfig(audio=Audio(stream="sounddevice:Stream")))
    other = RigConfig(audio=Audio(stream="antigravity:Stream"))
    with pytest.raises(ConfigError, match=r"audio.stream is 'antigravity:Stream', must be code that the daemon was"):
        known.refuse_other(other)
    assert "antigravity" not in sys.modules
    with pytest.raises(ConfigError, match="audio.relay.bus is 'os:system'"):
        known.refuse_other(RigConfig(audio=Audio(relay=Relay(bus="os:system"))))


def test_a_rig_file_can_name_a_block_of_ones_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "my_plant.py").write_text("from ctlblocks import Block\nclass Mine(Block):\n    pass\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert type(named_block("my_plant:Mine", {})).__name__ == "Mine"
    with pytest.raises(ValueError, match="my_plant:Mine does not take these options: .*'mass'"):
        named_block("my_plant:Mine", {"mass": 1})
