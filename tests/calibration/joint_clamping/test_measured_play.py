"""A measured friction damper with play in its linkage (Coble et al. 2022); skipped where the data are not."""

import pytest

from benchmarks.friction_damper import FILES, flanks, loop
from calibration.joint_clamping.extraction import extract
from tests.shared_data import shared


@pytest.mark.sample(1)
@pytest.mark.parametrize(("name", "play", "slides"), [(FILES[0], 1.8e-3, 12e3), (FILES[1], 1.3e-3, 12e3)])
def test_the_loop_is_friction_alone_and_its_flanks_show_the_play(name: str, play: float, slides: float) -> None:
    """The play, m, read off the flanks by eye, within a quarter: it differs from flank to flank by as much."""
    whole = loop(shared(f"friction_damper/{name}"))
    found = extract(whole)
    assert not found.has_backlash
    assert found.k_plus.low < 0 < found.k_plus.high
    assert found.friction.value == pytest.approx(slides, rel=0.25)
    parts = extract(flanks(whole))
    assert parts.has_backlash
    assert parts.backlash.value == pytest.approx(play, rel=0.25)
