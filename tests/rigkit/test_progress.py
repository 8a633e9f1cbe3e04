"""Progress of a long command, on a terminal and where there is none."""

import io

import pytest

from rigkit.progress import PlainMeter, progress


class Terminal(io.StringIO):
    """Text that says it is a terminal."""

    def isatty(self) -> bool:
        return True


class Clock:
    """Seconds that pass when told to."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def plain(total: float) -> tuple[PlainMeter, io.StringIO, Clock]:
    stream, clock = io.StringIO(), Clock()
    return PlainMeter("learning", total, stream, clock), stream, clock


def test_without_a_terminal_there_is_a_line_now_and_then_with_the_time_left() -> None:
    meter, stream, clock = plain(100)
    for done in range(1, 31):
        clock.now = float(done)
        meter.show(done, f"-{done} dB")
    assert stream.getvalue().splitlines() == [
        "learning 10 % after 0:10, 1:30 left  -10 dB",
        "learning 20 % after 0:20, 1:20 left  -20 dB",
        "learning 30 % after 0:30, 1:10 left  -30 dB",
    ]


def test_the_end_is_always_shown() -> None:
    meter, stream, _ = plain(3)
    meter.show(3)
    assert stream.getvalue() == "learning 100 % after 0:00\n"


def test_the_time_left_goes_by_the_rate_since_the_first_step() -> None:
    meter, stream, clock = plain(100)
    clock.now = 15.0  # what is compiled first, or was done by an earlier run, tells nothing of the rest
    meter.show(1)
    clock.now = 25.0
    meter.show(51)
    assert stream.getvalue().splitlines() == ["learning 1 % after 0:15", "learning 51 % after 0:25, 0:10 left"]


def test_an_event_is_said_at_once() -> None:
    meter, stream, _ = plain(3)
    meter.say("shot 2 [xrun] is repeated")
    assert stream.getvalue() == "shot 2 [xrun] is repeated\n"


def test_on_a_terminal_there_is_a_bar() -> None:
    stream = Terminal()
    with progress("learning", 4, stream=stream) as meter:
        meter.show(1)
        meter.say("shot 2 [xrun] is repeated")
        meter.show(4, "[V] -41 dB")
    text = stream.getvalue()
    assert "100%" in text
    assert "[V] -41 dB" in text
    assert "shot 2 [xrun] is repeated" in text


def test_progress_goes_to_stderr_so_that_stdout_is_for_results(capsys: pytest.CaptureFixture[str]) -> None:
    with progress("learning", 1) as meter:
        meter.show(1)
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == "learning 100 % after 0:00\n"
