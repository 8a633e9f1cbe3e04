"""The dynamic reference governor: against (3.8) to (3.12), and at the ends of the travel."""

import math

import numpy as np
import pytest

from stagectl.robot.midranging import reference_governor_kernel as kernel
from stagectl.robot.midranging.axis_record import LOOP
from stagectl.robot.midranging.loop_model_kernel import push
from stagectl.robot.midranging.reference_governor import Governor, control_response, process_response
from stagectl.robot.midranging.tuning import LoopModel

RATE = 250.0
LOOPS = {
    1: LoopModel((0.96,), (0.04,)),
    2: LoopModel((1.8, -0.84), (0.03, 0.01)),  # overshoots by a third
    3: LoopModel((2.1, -1.53, 0.38), (0.03, 0.03, -0.01)),
}


def _run(governor: Governor, model: LoopModel, wanted: np.ndarray) -> dict[str, np.ndarray]:
    """Return reference, position, control signal and share of a loop that is what its model says."""
    record, modelled = governor.packed(RATE), np.zeros(1, LOOP)[0]
    modelled["used"][: 2 * model.order] = model.parameters
    past_w, past_y, kept = np.zeros(4), np.zeros(4), []
    for value in wanted:
        position = past_y[: model.order] @ model.outputs + past_w[: model.order] @ model.inputs
        given = kernel.govern(record, modelled, model.order, value, position, position)
        push(modelled["inputs"], given)
        past_w, past_y = np.array([given, *past_w[:-1]]), np.array([position, *past_y[:-1]])
        kept.append((given, position, record["control"], record["share"]))
    return dict(zip(("given", "position", "control", "share"), np.array(kept).T, strict=True))


def _square(size: float) -> np.ndarray:
    return np.where(np.arange(1000) // 200 % 2, -size, size)


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("inner", [((5.0,), (1.0,)), ((5.0, -4.5), (1.0, -0.8)), ((4.0, -3.0), (2.0, -1.0, 0.2))])
def test_it_is_3_8_to_3_11(order: int, inner: tuple[tuple[float, ...], tuple[float, ...]]) -> None:
    governor, wanted = Governor(*inner, limit=10e-3), _square(5e-3)
    got = _run(governor, LOOPS[order], wanted)
    q, p = control_response(governor, LOOPS[order])
    u, w, shares = [0.0] * len(p), [0.0] * len(q), []
    for value in wanted:
        rest = sum(p[i] * u[-i] for i in range(1, len(p))) - sum(q[i] * w[-i] for i in range(1, len(q)))
        foreseen = (q[0] * value - rest) / p[0]
        share = 1.0
        if abs(foreseen) > governor.limit:
            share = (p[0] * math.copysign(governor.limit, foreseen) + rest - q[0] * w[-1]) / (q[0] * (value - w[-1]))
        w.append(w[-1] + share * (value - w[-1]))
        u.append((q[0] * w[-1] - rest) / p[0])
        shares.append(share)
    np.testing.assert_allclose(got["given"], w[len(q) :], atol=1e-12)
    np.testing.assert_allclose(got["control"], u[len(p) :], atol=1e-11)
    np.testing.assert_allclose(got["share"], shares, atol=1e-7)
    assert min(shares) < 0.9


@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_control_signal_keeps_its_limit(order: int) -> None:
    got = _run(Governor((5.0,), limit=10e-3), LOOPS[order], _square(5e-3))
    assert abs(got["control"]).max() <= 10e-3 * (1.0 + 1e-9)
    assert abs(got["control"]).max() >= 10e-3 * (1.0 - 1e-9)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_position_keeps_within_the_travel(order: int) -> None:
    free = _run(Governor((5.0,)), LOOPS[order], _square(3e-3))
    kept = _run(Governor((5.0,), travel=3e-3, lookahead=1.0), LOOPS[order], _square(3e-3))
    assert abs(kept["position"]).max() <= 3e-3 * (1.0 + 1e-9)
    assert abs(kept["position"]).max() >= 2.9e-3
    assert (abs(free["position"]).max() > 3.2e-3) == (order > 1)
    assert (kept["share"] >= 0.0).all()


def test_a_reference_beyond_the_travel_ends_at_its_end() -> None:
    kept = _run(Governor((5.0,), travel=2e-3), LOOPS[1], np.full(500, 7e-3))
    assert kept["position"][-1] == pytest.approx(2e-3, rel=1e-6)
    assert kept["position"].max() <= 2e-3


def test_within_both_limits_nothing_is_held_back() -> None:
    kept = _run(Governor((5.0,), limit=10e-3, travel=3e-3), LOOPS[2], _square(0.5e-3))
    np.testing.assert_array_equal(kept["given"], _square(0.5e-3))
    np.testing.assert_array_equal(kept["share"], 1.0)


def test_the_process_is_recovered_from_the_closed_loop() -> None:
    numerator, denominator = process_response(Governor((5.0,)), LOOPS[1])
    np.testing.assert_allclose(numerator / denominator[0], [0.0, 0.008])
    np.testing.assert_allclose(denominator / denominator[0], [1.0, -1.0])


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"numerator": (0.0, 5.0)}, r"has 0\.0 over 1\.0 as its direct term, must be > 0"),
        ({"numerator": (-5.0,)}, r"has -5\.0 over 1\.0"),
        ({"numerator": (1.0,) * 5}, "numerator is .* must be 1 to 4 finite numbers"),
        ({"numerator": (5.0,), "denominator": (math.nan,)}, "denominator is .* must be 1 to 4 finite numbers"),
        ({"numerator": (5.0,), "limit": 0.0}, r"limit is 0\.0 m/s, must be > 0"),
        ({"numerator": (5.0,), "travel": math.nan}, r"travel is nan m, must be > 0"),
        ({"numerator": (5.0,), "lookahead": math.inf}, r"lookahead is inf s, must be finite and >= 0"),
    ],
)
def test_a_wrong_setting_is_refused_by_name(wrong: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Governor(**wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_reference_is_the_farthest_that_held_from_now_on_stays_within_the_travel(order: int) -> None:
    """Against trying: a thousandth further, the position passes the end somewhere ahead."""
    outputs, inputs = np.array([0.5, 0.1, -0.05])[:order], np.array([1.5, -1.1, 0.05])[:order]
    model = LoopModel(tuple(outputs), tuple(inputs * (1.0 - outputs.sum()) / inputs.sum()))
    governor, random = Governor((5.0,), travel=1e-3, lookahead=0.2), np.random.default_rng(order)
    for _ in range(50):
        past_w, past_y = random.uniform(-0.2e-3, 0.2e-3, (2, 4))
        record, modelled = governor.packed(RATE), np.zeros(1, LOOP)[0]
        modelled["used"][: 2 * order] = model.parameters
        modelled["inputs"] = past_w[:3]
        record["positions"] = past_y[1:]
        given = kernel.govern(record, modelled, order, 5e-3, past_y[0], past_y[0])

        def ahead(held: float, inputs: np.ndarray = past_w, outputs: np.ndarray = past_y) -> float:
            w, y, most = list(inputs), list(outputs), 0.0
            for _ in range(50):
                w = [held, *w]
                y = [float(np.dot(y[:order], model.outputs) + np.dot(w[:order], model.inputs)), *y]
                most = max(most, abs(y[0]))
            return most

        assert ahead(given) <= 1e-3 * (1.0 + 1e-9)
        assert given >= 1e-3 * (1.0 - 1e-9) or ahead(given + 1e-6) > 1e-3
