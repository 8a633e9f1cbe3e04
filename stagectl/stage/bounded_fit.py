"""Coefficients that come nearest to what is wanted over frequency while gains keep their bounds, a convex problem."""

import numpy as np


def bounded_fit(answers: np.ndarray, wanted: np.ndarray, bounded: np.ndarray) -> np.ndarray | None:
    """Minimise |answers h - wanted|^2 over real h of sum one, while no element of |bounded h| is beyond one.

    Parameters
    ----------
    answers : complex array, shape (bins, n), any unit
        Weighted by how much each bin counts.
    wanted : complex array, shape (bins,), the same unit
    bounded : complex array, shape (bounds, n), 1

    Returns
    -------
    array, shape (n,), 1, or None
        None where the bounds leave nothing, or the solver has not come to an end.

    Source
    ------
    Boyd and Vandenberghe, Convex Optimization, 2004, section 4.4 (second-order cones); Goulart and Chen, Clarabel,
    arXiv 2405.12762 (the solver).
    """
    import clarabel  # 20 ms that every command would take
    from scipy.sparse import csc_matrix

    count = answers.shape[1]
    rows = np.concatenate([answers.real, answers.imag])
    aims = np.concatenate([wanted.real, wanted.imag])
    size = max(float(np.linalg.norm(aims)), np.finfo(float).tiny)
    cones = np.zeros((3 * len(bounded), count))  # (1, real, imaginary) of each bound lies in a cone
    cones[1::3], cones[2::3] = -bounded.real, -bounded.imag
    limits = np.zeros(3 * len(bounded))
    limits[::3] = 1.0
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solution = clarabel.DefaultSolver(
        csc_matrix(np.triu(rows.T @ rows) / size**2),
        -rows.T @ aims / size**2,
        csc_matrix(np.vstack([np.ones((1, count)), cones])),
        np.concatenate([[1.0], limits]),
        [clarabel.ZeroConeT(1), *(clarabel.SecondOrderConeT(3) for _ in bounded)],
        settings,
    ).solve()
    found = np.array(solution.x)
    ended = solution.status in (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)
    return found if ended and np.isfinite(found).all() else None
