"""JSON that other programs read as something else, or fail at, is refused in one line that says what is wrong."""

import json
from pathlib import Path

import pytest

from rigkit.json_file import DEEPEST, LARGEST_FILE, JsonError, json_value, read_json

DEEP = "objects or lists nested more than 12 deep"


def refusal(content: bytes, folder: Path, expected: type = dict) -> str:
    path = folder / "given.json"
    path.write_bytes(content)
    with pytest.raises(JsonError) as fault:
        read_json(path, expected)
    text = str(fault.value)
    assert text.isprintable()
    assert len(text) < len(str(path)) + 150
    return text.removeprefix(f"{path}: ")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "not JSON: Expecting value: line 1 column 1 (char 0)"),
        (b'{"a": 1,}', "not JSON: Expecting property name enclosed in double quotes: line 1 column 9 (char 8)"),
        (b'{\n"a": \xff}', "byte 0xff in line 2 is not UTF-8"),
        (b"[" * 200_000, DEEP),
        (b"[" * 200_000 + b"]" * 200_000, DEEP),
        (b'{"a":' * 200_000 + b"1" + b"}" * 200_000, DEEP),
        (b'{"a":' * 20 + b"1" + b"}" * 20, DEEP),
        (b'{"a": {"b": [1, NaN]}}', "a.b.1 is NaN, must be finite"),
        (b'{"a": -Infinity}', "a is -Infinity, must be finite"),
        (b'{"a": 1e999}', "a is Infinity, must be finite"),
        (b'{"a": 99999999999999999999}', "a is 99999999999999999999, must be within 64 bits"),
        (b'{"a": -' + b"9" * 1_000 + b"}", f"a is -{'9' * 59}..., must be within 64 bits"),
        (b'{"a": ' + b"9" * 5_000 + b"}", "Exceeds the limit (4300 digits) for integer string conversion: value has "
         "5000 digits"),
        (b'{"a": 1, "b": 2, "a": 3}', 'the key "a" is there twice'),
        (b'{"a": {"b": 2, "b": 2}}', 'the key "b" is there twice'),
        (b'{"a": ["x\\ud800"]}', 'a.0 is "x\\ud800", holds half a character, an unpaired surrogate'),
        (b'{"\\udc00": 1}', 'the key "\\udc00" holds half a character, an unpaired surrogate'),
        (b"[]", "is a list, must be an object"),
        (b"null", "is null, must be an object"),
        (b"true", "is true or false, must be an object"),
        (b'"text"', "is text, must be an object"),
        (b"3", "is a number, must be an object"),
        (b" " * (LARGEST_FILE + 1), f"more than {LARGEST_FILE} bytes"),
    ],
    ids=range(23),
)  # fmt: skip
def test_what_is_wrong_is_said_in_one_line(content: bytes, message: str, tmp_path: Path) -> None:
    assert refusal(content, tmp_path) == message


def test_an_object_where_a_list_belongs_is_refused(tmp_path: Path) -> None:
    assert refusal(b"{}", tmp_path, list) == "is an object, must be a list"


def test_what_is_sound_is_read_as_it_stands(tmp_path: Path) -> None:
    nested: object = "é \U0001f600"
    for _ in range(DEEPEST - 1):
        nested = [nested]
    given = {"a": nested, "b": [-(2**63), 2**63 - 1, 1e308, None, True], "": {}}
    (tmp_path / "given.json").write_bytes(b"\xef\xbb\xbf" + json.dumps(given).encode())
    assert read_json(tmp_path / "given.json", dict) == given
    assert json_value('"\\ud83d\\ude00"'.join("[]"), "here", list) == ["\U0001f600"]


def test_an_absent_file_and_a_folder_are_named(tmp_path: Path) -> None:
    for path, kind in ((tmp_path / "absent.json", FileNotFoundError), (tmp_path, IsADirectoryError)):
        with pytest.raises(kind) as fault:
            read_json(path, dict)
        assert fault.value.filename is not None
        assert str(fault.value.filename) == str(path)
