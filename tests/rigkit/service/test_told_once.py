"""What looks for a sentence that is told twice."""

import pytest

from tests.rigkit.service.told_once import repeated


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("/a.wav: No space left on device: 3 MB are free in /a/, 4 MB are wanted", []),
        ("3 recordings were discarded: an xrun, 3 callbacks (2 times); too loud", []),
        ("the gains are Pid(left=0.0, right=1.0), those of the models Pid(left=0.0, right=1.0)", []),
        ("an xrun, 3 callbacks; an xrun, 5 callbacks; too loud", ["an xrun, 0 callbacks"]),
        ("discarded: response 1 is clipped; response 1 is clipped", ["response 0 is clipped"]),
        ("lost for 20 ms; a person must acknowledge; a person must acknowledge", ["a person must acknowledge"]),
        ("the robot is held: the force is lost. The force: the force is lost", ["the force is lost"]),
    ],
)
def test_a_sentence_that_comes_twice_is_found_whatever_its_numbers_are(text: str, found: list[str]) -> None:
    assert repeated(text) == found
