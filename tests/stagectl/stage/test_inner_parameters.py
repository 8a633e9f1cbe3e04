"""Inner loops on their way to the stage's processor."""

import numpy as np
import pytest

from stagectl.stage.inner_parameters import inner_from, inner_parameters
from stagectl.stage.piezo_pid import Pid

LOOPS = [Pid(1.0, 2.0, -3.0, 4.0, 5.0, 6.0), Pid(6.0, 7.0, 0.0, 8.0, 9.0)]


def test_they_come_back_as_they_were() -> None:
    assert inner_from(("x", "y"), inner_parameters(("x", "y"), LOOPS)) == LOOPS


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"z.inner": np.ones(5)}, "parameter z.inner is unknown"),
        ({"x.inner": np.ones(4)}, r"parameter x.inner has shape \(4,\), must be \(6,\)"),
        (
            {"x.inner": np.array([1, 1, 1, 0.0, 1, 1])},
            "parameter x.inner is .*, must be finite, its time constants > 0 s",
        ),
        ({"y.inner": np.array([np.nan, 1, 1, 1, 1, 1])}, "parameter y.inner is .*, must be finite"),
    ],
)
def test_what_is_no_loop_is_refused(change: dict[str, np.ndarray], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        inner_from(("x", "y"), inner_parameters(("x", "y"), LOOPS) | change)
