"""Files that are no rig file: each gives one clear error, quickly."""

from pathlib import Path

import pytest

from rigkit.config_fault import ConfigError
from rigkit.config_source import LARGEST_FILE, file_values


def refusal(content: bytes, tmp_path: Path) -> str:
    path = tmp_path / "rig.toml"
    path.write_bytes(content)
    with pytest.raises(ConfigError) as fault:
        file_values(path)
    return str(fault.value).removeprefix(f"{path}: ")


def test_a_file_from_an_editor_that_marks_utf8_and_ends_lines_with_crlf_is_read(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_bytes(b"\xef\xbb\xbf[a]\r\nb = 1\r\n")
    assert file_values(path) == {"a": {"b": 1}}


def test_an_absent_file_and_a_folder_are_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"x\.toml: No such file or directory$"):
        file_values(tmp_path / "x.toml")
    with pytest.raises(ConfigError, match=r": Is a directory$"):
        file_values(tmp_path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"a = 1\nb = \xff", "byte 0xff in line 2 is not UTF-8"),
        (b"a = ", "not TOML: Invalid value (at end of document)"),
        (b"a = 1\na = 2", "not TOML: Cannot overwrite a value (at end of document)"),
        (b"#" * (LARGEST_FILE + 1), f"more than {LARGEST_FILE} bytes"),
        (b"a = " + b"[" * 100_000, "lists or tables nested more than 12 deep"),
        (b"a = " + b"{a=" * 100_000, "lists or tables nested more than 12 deep"),
        (b"a = " + b"[" * 20 + b"]" * 20, "a.0.0.0.0.0.0.0.0.0.0.0.0 is nested more than 12 deep"),
        (b"a." * 200_000 + b"a = 1", "a key of more than 12 parts"),
        (b'"a" . ' * 200 + b"a = 1", "a key of more than 12 parts"),
        (b"a = 2020-01-01", "a is 2020-01-01, must be text, a number, true or false"),
        (b"[a]\nb = [1.0, [nan]]", "a.b.1.0 is nan, must be finite"),
    ],
)
def test_what_is_wrong_with_a_file_is_said_in_one_line(content: bytes, message: str, tmp_path: Path) -> None:
    assert refusal(content, tmp_path) == message


def test_a_number_of_thousands_of_digits_is_refused(tmp_path: Path) -> None:
    assert refusal(b"a = " + b"9" * 5_000, tmp_path).startswith("not TOML: Exceeds the limit")


def test_dots_in_text_and_numbers_are_no_long_key(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(f'a = "{"see below." * 20}"\nb = [{"0.1, " * 50}]\n# {"." * 300}\n')
    assert len(file_values(path)["b"]) == 50
