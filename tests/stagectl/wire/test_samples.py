"""Blocks of samples on the wire: to half a count, never clipped."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from rigkit.wire.layout import GarbledError, Layout, WireError
from stagectl.wire import messages, samples

LONG = (messages.REFERENCE, messages.POSITION, messages.EXTENSION, messages.VOLTAGE)
SHORT = (messages.SLOW_REFERENCE, messages.SLOW_POSITION, messages.SLOW_EXTENSION, messages.SLOW_VOLTAGE)
ANY = st.sampled_from(LONG + SHORT)


def count(layout: Layout) -> int:
    return len(layout.fields) // 3


@given(st.data(), ANY, st.integers(0, 255))
def test_a_block_comes_back_within_half_a_count(data: st.DataObject, layout: Layout, counter: int) -> None:
    parts = data.draw(arrays(float, (count(layout), 3), elements=st.floats(-1.0, 1.0)))
    block = parts * samples.largest(layout)
    number, back = samples.decode(layout, samples.encode(layout, counter, block))
    assert number == counter
    assert np.abs(back - block).max() <= 0.5000001 * samples.resolution(layout)


@given(st.data(), ANY)
def test_counts_come_back_as_they_were(data: st.DataObject, layout: Layout) -> None:
    counts = data.draw(arrays(np.int16, (count(layout), 3), elements=st.integers(-32_767, 32_767)))
    frame = layout.pack(0, *counts.ravel().tolist())
    assert samples.encode(layout, 0, samples.decode(layout, frame)[1]) == frame


@pytest.mark.parametrize("layout", LONG)
@pytest.mark.parametrize("factor", [1.0001, -1.0001, np.inf])
def test_a_value_beyond_the_range_is_refused_by_axis_and_sample(layout: Layout, factor: float) -> None:
    block = np.zeros((10, 3))
    block[4, 1] = factor * samples.largest(layout)
    with pytest.raises(WireError, match=rf"{layout.name}: y is .* in sample 4, must be within \+-"):
        samples.encode(layout, 0, block)


def test_the_ranges_are_those_of_the_stage() -> None:
    assert samples.largest(messages.POSITION) == pytest.approx(327.67e-6)
    assert samples.resolution(messages.POSITION) == pytest.approx(0.01e-6)
    assert samples.largest(messages.EXTENSION) == pytest.approx(163.835e-6)
    assert samples.largest(messages.VOLTAGE) == pytest.approx(1638.35)
    assert [samples.unit(layout) for layout in LONG] == ["m", "m", "m", "V"]


def test_a_sample_that_is_not_valid_is_nan_on_both_sides() -> None:
    block = np.zeros((10, 3))
    block[3, 2] = np.nan
    back = samples.decode(messages.POSITION, samples.encode(messages.POSITION, 0, block))[1]
    np.testing.assert_array_equal(np.isnan(back), np.isnan(block))


def test_a_reference_is_a_number() -> None:
    with pytest.raises(WireError, match="Reference: x is nan m"):
        samples.encode(messages.REFERENCE, 0, np.full((10, 3), np.nan))
    with pytest.raises(GarbledError, match="-32768 counts"):
        samples.decode(messages.REFERENCE, messages.REFERENCE.pack(0, *[samples.INVALID] * 30))


@pytest.mark.parametrize("shape", [(9, 3), (10, 2), (3, 10), (30,)])
def test_a_block_of_another_shape_is_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(WireError, match="must be of 30 samples"):
        samples.encode(messages.REFERENCE, 0, np.zeros(shape))


@given(st.data(), ANY)
def test_a_signal_is_rounded_to_what_its_frame_gives_back(data: st.DataObject, layout: Layout) -> None:
    parts = data.draw(arrays(float, (count(layout), 3), elements=st.floats(-1.0, 1.0)))
    block = parts * samples.largest(layout)
    _, back = samples.decode(layout, samples.encode(layout, 0, block))
    np.testing.assert_allclose(samples.rounded(layout, block), back, rtol=0, atol=1e-6 * samples.resolution(layout))
