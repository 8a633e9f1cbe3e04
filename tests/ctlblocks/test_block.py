"""Ports and blocks refuse what could not be wired."""

import numpy as np
import pytest

from ctlblocks import Block, Port
from ctlblocks.block import refuse_other_arguments


@pytest.mark.parametrize("name", ["", "2nd", "a b", "a.b", "class"])
def test_a_port_name_that_cannot_be_an_argument_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match=f"port name '{name}' is not a Python identifier"):
        Port(name)


@pytest.mark.parametrize("unit", ["", " ", "V "])
def test_an_empty_or_padded_unit_is_refused(unit: str) -> None:
    with pytest.raises(ValueError, match=f"port drive: unit is '{unit}', must be a unit"):
        Port("drive", unit)


@pytest.mark.parametrize("width", [0, -1, 1.0, True])
def test_a_width_that_is_no_count_of_channels_is_refused(width: int) -> None:
    with pytest.raises(ValueError, match=f"port drive: width is {width}, must be a whole number >= 1"):
        Port("drive", "V", width)


class Scale(Block):
    inputs = (Port("raw"),)
    outputs = (Port("scaled"),)

    def process(self, raw: np.ndarray, scaled: np.ndarray) -> None:
        np.multiply(raw, 2.0, out=scaled)


class Swapped(Scale):
    def process(self, scaled: np.ndarray, raw: np.ndarray) -> None:
        np.multiply(raw, 2.0, out=scaled)


class Short(Scale):
    def process(self, raw: np.ndarray) -> None:  # type: ignore[override]
        raw.sum()


class ByPosition(Scale):
    def process(self, *signals: np.ndarray) -> None:
        np.multiply(signals[0], 2.0, out=signals[1])


class TwoOfAName(ByPosition):
    outputs = (Port("raw"),)


@pytest.mark.parametrize("block", [Scale(), ByPosition()])
def test_arguments_named_as_the_ports_or_taken_by_position_pass(block: Block) -> None:
    refuse_other_arguments(block)


@pytest.mark.parametrize(
    ("block", "arguments"), [(Swapped(), "scaled, raw"), (Short(), "raw"), (TwoOfAName(), "signals")]
)
def test_arguments_that_are_not_the_ports_are_refused_by_name(block: Block, arguments: str) -> None:
    ports = ", ".join(port.name for port in (*block.inputs, *block.outputs))
    with pytest.raises(TypeError) as refused:
        refuse_other_arguments(block)
    assert str(refused.value) == f"{type(block).__name__}.process takes ({arguments}), must take its ports ({ports})"


def test_a_block_that_does_nothing_is_refused() -> None:
    with pytest.raises(TypeError, match=r"Block has no process\(\)"):
        refuse_other_arguments(Block())
