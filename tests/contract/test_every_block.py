"""One suite over every Block in the project; a Block without an example in examples.py fails it by name."""

from collections.abc import Callable

import pytest

from ctlblocks import Block
from tests.contract.conformance import CHECKS, Example, every_block
from tests.contract.examples import EXAMPLES


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__.removeprefix("check_"))
@pytest.mark.parametrize("kind", every_block(), ids=lambda kind: f"{kind.__module__}.{kind.__name__}")
def test_every_block(kind: type[Block], check: Callable[[Example], None]) -> None:
    assert kind in EXAMPLES, f"{kind.__module__}.{kind.__name__} has no example in tests/contract/examples.py"
    assert type(EXAMPLES[kind].make()) is kind
    check(EXAMPLES[kind])


def test_no_example_is_of_a_block_that_is_gone() -> None:
    assert set(EXAMPLES) <= set(every_block())
