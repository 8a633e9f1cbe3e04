"""Names of code lead to it, or say where they end."""

from pathlib import Path

import pytest

from rigkit.code_name import refuse_absent, resolve
from rigkit.config import ConfigError
from tests.rigkit.rig_file import RigFile


def test_a_name_is_resolved() -> None:
    assert resolve("tests.rigkit.rig_file:RigFile") is RigFile


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("rigkit.config", "'rigkit.config' names nothing, must be package.module:Name"),
        ("rigkit.config:a.b", "'rigkit.config:a.b' names nothing, must be package.module:Name"),
        ("nowhere.at_all:X", "nowhere.at_all:X: there is no module nowhere on the Python path"),
        ("rigkit.nowhere:X", "rigkit.nowhere:X: there is no module rigkit.nowhere on the Python path"),
        ("rigkit.config:Sction", "rigkit.config:Sction: module rigkit.config has no Sction; did you mean Section?"),
        ("rigkit.config:Parallel", "rigkit.config:Parallel: module rigkit.config has no Parallel"),
    ],
)
def test_a_name_that_leads_nowhere_says_where_it_ends(name: str, message: str) -> None:
    with pytest.raises(ConfigError) as fault:
        resolve(name)
    assert str(fault.value) == message


def test_a_module_that_fails_on_import_is_not_called_absent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "needs_more.py").write_text("import a_package_nobody_has\n")
    with pytest.raises(ConfigError, match="module needs_more cannot be imported: No module named 'a_package"):
        resolve("needs_more:X")


def test_a_module_is_looked_for_without_importing_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "explodes.py").write_text("raise RuntimeError")
    monkeypatch.syspath_prepend(str(tmp_path))
    refuse_absent("explodes:Anything")
    for name in ("absent:X", "absent.below:X", "rigkit.absent:X"):
        with pytest.raises(ConfigError, match=f"{name}: there is no module {name.split(':')[0]} on the Python path"):
            refuse_absent(name)
    with pytest.raises(ConfigError, match="must be package.module:Name"):
        refuse_absent("explodes")
