"""Values that an earlier command has written."""

from pathlib import Path

import pytest

from rigkit.study.late_value import with_late_values


def test_values_of_files_take_their_places(tmp_path: Path) -> None:
    (tmp_path / "drawn.json").write_text('{"drawn": {"level of 2": 0.25, "on": true}, "names": ["sine:24:5"]}')
    words = ("run", 'a={drawn.json:drawn."level of 2"}', "{drawn.json:names[0]}", "{drawn.json:drawn.on}", "{x}")
    assert with_late_values(words, tmp_path) == ("run", "a=0.25", "sine:24:5", "true", "{x}")


def test_what_is_not_there_is_named(tmp_path: Path) -> None:
    (tmp_path / "drawn.json").write_text('{"rig": {}}')
    with pytest.raises(LookupError, match=r"drawn\.json: rig has no level"):
        with_late_values(("{drawn.json:rig.level}",), tmp_path)
    with pytest.raises(FileNotFoundError):
        with_late_values(("{other.json:rig}",), tmp_path)
