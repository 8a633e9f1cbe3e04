"""The laser sensor's lines, as its manual prints them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stagectl.link.laser_protocol import LONGEST_LINE, LaserError, Lines, Reading, reading, request, said


@pytest.mark.parametrize(
    ("line", "output", "displayed"),
    [
        (b"M1,+01.2345", 1, 1.2345),
        (b"M2,-00.0120", 2, -0.012),
        (b"M1,+1234.56", 1, 1234.56),
        (b"m1,-00001.2", 1, -1.2),
        (b"TG,1,+00.0000", 1, 0.0),
        (b"TG,2,+1234567", 2, 1234567.0),
    ],
)
def test_values_are_read(line: bytes, output: int, displayed: float) -> None:
    assert reading(line) == Reading(output, displayed)


@pytest.mark.parametrize("value", [b"+FFFFFFF", b"-FFFFFFF", b"XXXXXXXX"])
def test_out_of_range_and_no_value_are_nan(value: bytes) -> None:
    assert math.isnan(reading(b"M1," + value).displayed)


@pytest.mark.parametrize(
    "line",
    [b"", b"M1", b"M1,", b"M3,+01.2345", b"M1,+01.234", b"M1,+01.23456", b"M1,01.23456", b"M1,+1.2.345", b"M1,+.......",
     b"\xff\xfe\x00", b"TG,1", b"M1,+01.2345,", b"M1,+ 1.2345", b"M1,+1_2.345", b"M1,+     inf", b"M1,+0x12345"],
)  # fmt: skip
def test_a_line_that_is_no_value_is_refused(line: bytes) -> None:
    with pytest.raises(LaserError, match="the laser sensor says"):
        reading(line)


@pytest.mark.parametrize(("line", "why"), [(b"ER,M1,01", "'M1': status error"), (b"ER,Q9,00", "'Q9': command error")])
def test_a_refusal_says_what_was_refused_and_why(line: bytes, why: str) -> None:
    with pytest.raises(LaserError, match=f"refuses {why}"):
        reading(line)


@given(st.floats(-99.99, 99.99))
def test_what_is_said_is_read(displayed: float) -> None:
    assert reading(b"M1," + said(displayed)).displayed == pytest.approx(displayed, abs=0.5001e-4)


@pytest.mark.parametrize(("displayed", "value"), [(1e3, b"+FFFFFFF"), (-1e3, b"-FFFFFFF"), (math.nan, b"XXXXXXXX")])
def test_what_cannot_be_said_is_said_so(displayed: float, value: bytes) -> None:
    assert said(displayed) == value


@given(st.lists(st.binary(max_size=5).filter(lambda data: b"\n" not in data), max_size=30))
def test_lines_are_put_together_from_any_pieces(pieces: list[bytes]) -> None:
    lines = Lines()
    whole = b"".join(pieces)
    found = [line for piece in pieces for line in lines.take(piece)]
    if len(whole) <= LONGEST_LINE:
        assert found == [line for line in whole.split(b"\r")[:-1] if line]


def test_bytes_without_an_end_are_dropped() -> None:
    lines = Lines()
    assert lines.take(b"x" * (LONGEST_LINE + 1)) == []
    assert lines.take(b"M1,+00.0000\r\n") == [b"M1,+00.0000"]


def test_a_line_that_is_not_complete_can_be_forgotten() -> None:
    lines = Lines()
    lines.take(b"TG,1,+0")
    lines.forget()
    assert lines.take(b"M1,+00.0000\r") == [b"M1,+00.0000"]


def test_a_request_is_a_command_and_its_end() -> None:
    assert request(2) == b"M2\r"
