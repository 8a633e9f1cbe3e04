"""A path as a machine drives it."""

import re

import pytest

from stagectl.planning.cutting import Cutting
from stagectl.planning.exact import ExactPlanner
from stagectl.planning.milling import mill
from stagectl.planning.problem import Pocket, PocketFault
from stagectl.planning.toolpath import gcode, rapid, targets
from tests.stagectl.planning.pockets import EXAMPLE, figure_8_8

POCKET = Pocket.from_dict(EXAMPLE)
SEGMENTS = mill(POCKET, ExactPlanner(POCKET))


def test_the_first_slot_begins_a_radius_from_two_walls_and_ends_a_radius_from_the_third() -> None:
    above, down, end, *_ = targets(SEGMENTS, POCKET, Cutting())
    assert (above.x, above.y, above.z) == pytest.approx((3e-3, 3e-3, 5e-3))  # the south-west corner
    assert (down.x, down.y, down.z) == pytest.approx((3e-3, 3e-3, -3e-3))
    assert (end.x, end.y, end.z) == pytest.approx((57e-3, 3e-3, -3e-3))
    assert end.speed == pytest.approx(60e-3 / 2.25)


def test_the_tool_stays_within_the_walls_and_is_above_only_where_it_was_lifted() -> None:
    moves = list(targets(SEGMENTS, POCKET, Cutting()))
    assert all(3e-3 - 1e-12 <= each.x <= 57e-3 + 1e-12 and 3e-3 - 1e-12 <= each.y <= 57e-3 + 1e-12 for each in moves)
    assert [n for n, each in enumerate(moves) if each.z > 0.0] == [0, len(moves) - 1]
    assert len(moves) == 2 * len(SEGMENTS) + 2


def test_nothing_in_the_material_is_driven_fast() -> None:
    pocket = figure_8_8(0.243)
    for each in targets(mill(pocket, ExactPlanner(pocket)), pocket, Cutting()):
        assert each.is_fast == (each.z > 0.0)


def test_g_code_is_in_mm_and_mm_per_minute() -> None:
    lines = gcode(SEGMENTS, POCKET, Cutting()).splitlines()
    assert lines[1] == "G21 G90 G94"
    assert lines[2:5] == [
        "G0 X3.000 Y3.000 Z5.000",
        "G1 X3.000 Y3.000 Z-3.000 F1600.0",
        "G1 X57.000 Y3.000 Z-3.000 F1600.0",
    ]
    assert lines[-1] == "M2"


def test_a_rapid_module_moves_linearly_in_its_work_object() -> None:
    text = rapid(SEGMENTS, POCKET, Cutting())
    moves = re.findall(r"MoveL \[\[([-\d.,]+)\],.*\], \[([\d.]+),500,5000,1000\], fine, tPocket\\WObj:=wPocket;", text)
    assert len(moves) == len(list(targets(SEGMENTS, POCKET, Cutting())))
    assert moves[2] == ("57.000,3.000,-3.000", "26.7")
    assert text.startswith("MODULE Pocket\n")
    assert text.endswith("ENDMODULE\n")


@pytest.mark.parametrize("name", ["cell", "depth", "clearance", "speed"])
def test_what_no_machine_can_drive_is_refused(name: str) -> None:
    with pytest.raises(PocketFault, match=f"{name} is nan, must be > 0"):
        Cutting(**{name: float("nan")})
