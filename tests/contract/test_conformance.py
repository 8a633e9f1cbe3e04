"""Each check of the conformance suite catches a block that breaks just that promise, and passes one that keeps all."""

import ast
import inspect
from collections.abc import Callable

import numpy as np
import pytest
from numba import njit

from ctlblocks import Block, Port
from tests.contract import conformance
from tests.contract.conformance import CHECKS, Example


class Good(Block):
    """Twice the input plus the input before."""

    inputs = (Port("raw", width=2),)
    outputs = (Port("smooth", width=2),)

    def prepare(self, rate: float, frames: int) -> None:
        self.last = np.zeros(2)

    def process(self, raw: np.ndarray, smooth: np.ndarray) -> None:
        np.multiply(raw, 2.0, out=smooth)
        smooth[0] += self.last
        smooth[1:] += raw[:-1]
        self.last[:] = raw[-1]


class Swapped(Good):
    def process(self, smooth: np.ndarray, raw: np.ndarray) -> None:  # type: ignore[override]
        super().process(smooth, raw)


class InPlace(Good):
    def process(self, raw: np.ndarray, smooth: np.ndarray) -> None:
        super().process(raw, smooth)
        raw *= 2.0


class Unwritten(Good):
    def process(self, raw: np.ndarray, smooth: np.ndarray) -> None:
        last = smooth[-1, 1]
        super().process(raw, smooth)
        smooth[-1, 1] = last


class PerFrame(Good):
    def process(self, raw: np.ndarray, smooth: np.ndarray) -> None:
        super().process(raw, smooth)
        smooth[0] = 0.0


class Remembers(Good):
    last = np.zeros(2)

    def prepare(self, rate: float, frames: int) -> None:
        """Reset nothing."""


class KeepsLength(Good):
    """Reset all but the length of the frames first prepared for."""

    frames = 0

    def prepare(self, rate: float, frames: int) -> None:
        super().prepare(rate, frames)
        self.frames = self.frames or frames

    def process(self, raw: np.ndarray, smooth: np.ndarray) -> None:
        super().process(raw, smooth)
        smooth *= len(raw) / self.frames


class Temporary(Good):
    def process(self, raw: np.ndarray, smooth: np.ndarray) -> None:
        smooth[:] = raw * 2.0


class Mask(Good):
    def process(self, raw: np.ndarray, smooth: np.ndarray) -> None:
        np.multiply(raw, 2.0, out=smooth)
        np.isnan(raw[:, 0])


@njit(nogil=True)
def _doubled(raw, smooth):  # type: ignore[no-untyped-def]
    twice = np.empty_like(raw)
    for n in range(len(raw)):
        twice[n] = 2.0 * raw[n]
    smooth[:] = twice


class CompiledTemporary(Good):
    def process(self, raw: np.ndarray, smooth: np.ndarray) -> None:
        _doubled(raw, smooth)


class Lingering(Good):
    def process(self, raw: np.ndarray, smooth: np.ndarray) -> None:
        before = 0.5 * self.last
        super().process(raw, smooth)
        self.last += before


@pytest.mark.parametrize("check", CHECKS)
def test_a_good_block_passes_every_check(check: Callable[[Example], None]) -> None:
    check(Example(Good))


@pytest.mark.parametrize(
    ("bad", "check", "message"),
    [
        (Swapped, conformance.check_arguments_are_ports, r"Swapped.process takes \(smooth, raw\)"),
        (InPlace, conformance.check_inputs_are_untouched, "InPlace writes into its input raw"),
        (Unwritten, conformance.check_every_sample_is_written, r"Unwritten leaves smooth\[511, 1\] unwritten"),
        (PerFrame, conformance.check_frames_do_not_matter, "512 frames and 8 x 64 differ in smooth from sample 64"),
        (KeepsLength, conformance.check_frames_do_not_matter, "512 frames and 8 x 64 differ in smooth from sample 0"),
        (Remembers, conformance.check_prepare_resets, "Remembers: prepare does not reset it in smooth from sample 0"),
        (Temporary, conformance.check_nothing_is_allocated, r"Temporary allocates 2\d{5} bytes"),
        (Mask, conformance.check_nothing_is_allocated, r"Mask allocates 1\d{4} bytes"),
        (CompiledTemporary, conformance.check_nothing_is_allocated, r"CompiledTemporary allocates 2\d{5} bytes"),
        (Lingering, conformance.check_silence_leaves_nothing_subnormal, r"Lingering holds -?\d.*e-3\d\d after 32768 "),
    ],
)
def test_a_bad_block_is_caught_by_name(bad: type[Block], check: Callable[[Example], None], message: str) -> None:
    with pytest.raises((AssertionError, TypeError), match=message):
        check(Example(bad))


def test_every_check_has_a_bad_block() -> None:
    source = ast.parse(inspect.getsource(inspect.getmodule(test_a_bad_block_is_caught_by_name)))  # type: ignore[arg-type]
    used = {node.attr for node in ast.walk(source) if isinstance(node, ast.Attribute)}
    assert {check.__name__ for check in CHECKS} <= used


def test_blocks_are_found_without_being_imported_first_and_those_of_tests_are_not() -> None:
    found = {kind.__name__ for kind in conformance.every_block()}
    assert {"Gain", "Replay", "Guard", "Vibrator"} <= found
    assert "Good" not in found


def test_a_check_starts_a_block_after_every_prepare_at_its_own_rate() -> None:
    class Asks(Good):
        def prepare(self, rate: float, frames: int) -> None:
            super().prepare(rate, frames)
            assert rate == 250.0
            self.started = False

        def process(self, raw: np.ndarray, smooth: np.ndarray) -> None:
            assert self.started
            super().process(raw, smooth)

    for check in CHECKS:
        check(Example(Asks, start=lambda block: setattr(block, "started", True), rate=250.0))
