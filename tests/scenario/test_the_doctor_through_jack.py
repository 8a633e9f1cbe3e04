"""The doctor on a real audio server, whose client is wired otherwise than the rig file says.

It guards against a channel map that only the simulated card, wired by the same rig file, would agree with.  Plays in
real time, so it takes half a minute a rig.
"""

import pytest

from benchmarks.jack_server import jack_server, missing, vibrator_client
from tests.vibractl.doctor.doctor_rig import verdict
from vibractl.config import Audio, RigConfig
from vibractl.doctor.examination import Examination, examine

pytestmark = [pytest.mark.skipif(bool(missing()), reason=missing()), pytest.mark.slow]


def examined(**audio: object) -> Examination:
    wanted = {"stream": "sounddevice:Stream", "device": "shaker", "blocksize": 1024, "attempts": 20}
    with jack_server(["-r", "-S"], 44_100, 1024), vibrator_client([]):
        return examine(RigConfig(audio=Audio.model_validate(wanted | audio)))


def test_a_rig_that_is_wired_as_it_says_has_no_failure() -> None:
    found = examined()
    assert not found.failed
    assert verdict(found, "loopback").detail["delay_samples"] == pytest.approx(2048, abs=1e-3)
    assert abs(verdict(found, "clock").value) < 1e-3


def test_accelerometers_in_each_others_inputs_are_found() -> None:
    said = verdict(examined(response_channels=(2, 1)), "channel map")
    assert said.grade == "fail"
    assert "audio.response_channels = [1, 2]" in said.advice


def test_a_cable_in_an_accelerometers_input_is_found_there() -> None:
    found = examined(loopback_input=1, response_channels=(3, 2))
    assert verdict(found, "loopback").advice == "the cable is in input 3, must be in 1"
    assert "response 1 responds to no coil" in verdict(found, "channel map").measured
