"""The environment, by gymnasium's own checker, and by the optimum driven through it."""

from typing import Any

import numpy as np
import pytest

from stagectl.planning.exact import least_time
from stagectl.planning.pocket import planner
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import after, untouched
from tests.stagectl.planning.pockets import EXAMPLE, figure_8_8

pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env

from stagectl.planning.environment import PocketEnv


def test_gymnasium_s_own_checker_passes_it() -> None:
    for pocket in (Pocket.from_dict(EXAMPLE), figure_8_8(0.243)):
        check_env(PocketEnv(pocket), skip_render_check=True, skip_close_check=True)


def test_the_return_of_the_optimum_is_minus_its_time() -> None:
    pocket = Pocket.from_dict(EXAMPLE)
    env, best, standing = PocketEnv(pocket), planner("exact", pocket), untouched(pocket)
    env.reset()
    whole, is_done = 0.0, False
    while not is_done:
        cut = best.choose(standing)
        standing = after(cut, standing)
        _, reward, is_done, _, _ = env.step(np.int64(cut.way * 3 + cut.k - 1))
        whole += reward
    assert -whole == pytest.approx(least_time(pocket))
    with pytest.raises(ValueError, match="the pocket is milled"):
        env.step(np.int64(0))


def test_any_legal_actions_end_the_pocket_and_an_illegal_one_changes_nothing() -> None:
    env, rng = PocketEnv(figure_8_8(0.243)), np.random.default_rng(1)
    seen, info = env.reset()
    is_done = False
    while not is_done:
        mask: Any = info["action_mask"]
        if not mask.all():
            same, reward, is_done, _, _ = env.step(np.int64(np.flatnonzero(mask == 0)[0]))
            np.testing.assert_array_equal(same, seen)
            assert reward < -10.0
        seen, _, is_done, is_cut_short, info = env.step(np.int64(rng.choice(np.flatnonzero(mask))))
        assert not is_cut_short
    assert not info["action_mask"].any()


def test_an_episode_that_goes_nowhere_is_cut_short() -> None:
    env = PocketEnv(Pocket.from_dict(EXAMPLE))
    _, info = env.reset()
    illegal = np.int64(np.flatnonzero(info["action_mask"] == 0)[0])
    assert [env.step(illegal)[3] for _ in range(240)] == [False] * 239 + [True]


def test_an_action_that_is_none_is_refused() -> None:
    env = PocketEnv(Pocket.from_dict(EXAMPLE))
    env.reset()
    with pytest.raises(ValueError, match="action is 12, must be 0 to 11"):
        env.step(np.int64(12))
