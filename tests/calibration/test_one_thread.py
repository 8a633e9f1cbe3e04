"""Threads of linear algebra: one inside, as before outside."""

import numpy as np
from threadpoolctl import threadpool_info

from calibration.one_thread import on_one_thread
from calibration.prediction_error import refine


def threads() -> list[int]:
    """Return how many threads each library of linear algebra uses."""
    return [library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"]


def test_a_function_runs_on_one_thread_and_leaves_no_trace() -> None:
    before = threads()

    @on_one_thread
    def seen(extra: int) -> list[int]:
        """Look."""
        assert np.linalg.inv(np.eye(2)).shape == (2, 2)
        return [*threads(), extra]

    assert seen(extra=1) == [1] * len(before) + [1]
    assert threads() == before
    assert seen.__doc__ == "Look."


def test_refinement_is_such_a_function() -> None:
    assert hasattr(refine, "__wrapped__")
