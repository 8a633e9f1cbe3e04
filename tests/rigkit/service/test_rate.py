"""How often one address may ask."""

from rigkit.service.rate import MOST, Rates


def test_a_burst_and_then_the_long_run_rate() -> None:
    rates = Rates(2.0, 5.0)
    assert [rates.allows("here", 0.0) for _ in range(7)] == [True] * 5 + [False] * 2
    assert [rates.allows("here", now) for now in (0.4, 0.5, 0.6, 1.0, 1.1)] == [False, True, False, True, False]


def test_one_address_does_not_use_up_anothers() -> None:
    rates = Rates(1.0, 1.0)
    assert rates.allows("here", 0.0)
    assert not rates.allows("here", 0.0)
    assert rates.allows("there", 0.0)


def test_addresses_without_end_take_no_memory_without_end() -> None:
    rates = Rates(1.0, 1.0)
    for number in range(3 * MOST):
        rates.allows(str(number), 0.0)
    assert len(rates._buckets) == MOST  # noqa: SLF001
