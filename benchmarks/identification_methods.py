"""Identification by this program and by other packages: arrays in, a model's matrices out.

Each method imports what it needs when it is chosen, so that a process knows one package only.  What a package does not
have (a Kalman gain, a way to an order) is added only where its own figures determine it: a gain from its covariances.
"""

import contextlib
import io
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from scipy.linalg import solve_discrete_are

Matrices = dict[str, np.ndarray]
"""A, B, C, D and, where there is one, K; `input_offset` and `output_offset` where an operating point is taken out."""

Method = Callable[[np.ndarray, np.ndarray, int, int], Matrices]
"""Of a drive (N, m), a response (N, p), an order and a horizon; ours takes 0 for what is left to it."""

Proposal = Callable[[np.ndarray, np.ndarray, int], int]
"""The order found in a drive and a response with a horizon."""

RATE = 1000.0
TAPS = 150
"""Of the impulse response that the eigensystem realization is made of."""
LARGEST_ORDER = 25
"""Up to which a package that wants a range looks for the order."""


def ours(method: str, refined: bool) -> Method:
    from calibration import subspace
    from calibration.prediction_error import refine

    def identify(drive: np.ndarray, response: np.ndarray, order: int, horizon: int) -> Matrices:
        found = subspace.identify(
            drive, response, RATE, order=order or None, horizon=horizon or None, method=method, delay=0
        )
        model = found.model
        if refined:
            model = refine(model, drive - found.input_offset, response - found.output_offset).model
        offsets = {"input_offset": found.input_offset, "output_offset": found.output_offset}
        return {**{name: getattr(model, name) for name in "ABCDK"}, **offsets}

    return identify


def own_horizon() -> Method:
    identify = ours("moesp", refined=False)
    return lambda drive, response, order, _: identify(drive, response, order, 0)


def own_all() -> Method:
    """Return the call that says nothing: order, horizon, dead time and loops are found."""
    from calibration import subspace

    def identify(drive: np.ndarray, response: np.ndarray, *_: int) -> Matrices:
        found = subspace.identify(drive, response, RATE)
        offsets = {"input_offset": found.input_offset, "output_offset": found.output_offset}
        return {**{name: getattr(found.model, name) for name in "ABCDK"}, **offsets}

    return identify


def our_order() -> Proposal:
    identify = ours("moesp", refined=False)
    return lambda drive, response, horizon: len(identify(drive, response, 0, horizon)["A"])


def slicot(method: str, compression: str = "C", gain: str = "C") -> Method:
    """SLICOT's IB01AD and IB01BD; for MOESP with B and D by IB01CD, since IB01BD's are wrong in this wrapper."""
    import ctrlsys

    def identify(drive: np.ndarray, response: np.ndarray, order: int, horizon: int) -> Matrices:
        u, y = np.asfortranarray(drive), np.asfortranarray(response)
        inputs, outputs = u.shape[1], y.shape[1]
        _, r, _, _, info = ctrlsys.ib01ad(
            method, compression, "M", "O", "N", "N", horizon, inputs, outputs, u.copy("F"), y.copy("F"), 0.0, -1.0
        )
        _accept("IB01AD", info)
        A, C, B, D, Q, Ry, S, K, _, info = ctrlsys.ib01bd(  # noqa: N806
            method, "A", gain, horizon, order, inputs, outputs, len(u), r, 0.0
        )
        _accept("IB01BD", info)
        if method == "M":
            _, B, D, _, _, _, info = ctrlsys.ib01cd(  # noqa: N806
                "X", "C", "D", order, inputs, outputs, A, np.zeros((order, inputs), order="F"), C,
                np.zeros((outputs, inputs), order="F"), u.copy("F"), y.copy("F"), 0.0,
            )  # fmt: skip
            _accept("IB01CD", info)
        return _with_gain((A, B, C, D), Q, Ry, S) if gain == "C" else {"A": A, "B": B, "C": C, "D": D, "K": K}

    return identify


def slicot_order() -> Proposal:
    import ctrlsys

    def propose(drive: np.ndarray, response: np.ndarray, horizon: int) -> int:
        u, y = np.asfortranarray(drive), np.asfortranarray(response)
        widths = u.shape[1], y.shape[1]
        order, _, _, _, info = ctrlsys.ib01ad("N", "C", "M", "O", "N", "N", horizon, *widths, u, y, 0.0, -1.0)
        _accept("IB01AD", info)
        return int(order)

    return propose


def sippy(method: str) -> Method:
    run = _sippy(method)

    def identify(drive: np.ndarray, response: np.ndarray, order: int, horizon: int) -> Matrices:
        found = run(drive, response, SS_f=horizon, SS_p=horizon, SS_fixed_order=order)
        return {name: np.asarray(getattr(found, name), float) for name in "ABCDK"}

    return identify


def sippy_order() -> Proposal:
    run = _sippy("N4SID")

    def propose(drive: np.ndarray, response: np.ndarray, horizon: int) -> int:
        return int(run(drive, response, IC="AIC", SS_f=horizon, SS_p=horizon, SS_orders=[1, LARGEST_ORDER]).n)

    return propose


def sippy_armax() -> Method:
    run = _sippy("ARMAX")

    def identify(drive: np.ndarray, response: np.ndarray, order: int, _horizon: int) -> Matrices:
        found = run(drive, response, ARMAX_orders=[order, order, order, 1])
        through, shaping = found.G, found.H
        denominator = np.ravel(through.den[0][0])
        tops = (np.ravel(side.num[0][0]) for side in (through, shaping))
        from_drive, from_noise = (np.pad(top, (len(denominator) - len(top), 0)) for top in tops)
        return companion(denominator, from_drive, from_noise)

    return identify


def nfoursid() -> Method:
    import pandas as pd
    from nfoursid.nfoursid import NFourSID

    def identify(drive: np.ndarray, response: np.ndarray, order: int, horizon: int) -> Matrices:
        inputs, outputs = (
            [f"{side}{n}" for n in range(each.shape[1])] for side, each in (("u", drive), ("y", response))
        )
        frame = pd.DataFrame(np.concatenate([drive, response], axis=1), columns=[*inputs, *outputs])
        job = NFourSID(frame, outputs, inputs, horizon)
        job.subspace_identification()
        found, covariance = job.system_identification(order)
        wide = len(outputs)
        noise = covariance[wide:, wide:], covariance[:wide, :wide], covariance[wide:, :wide]
        return _with_gain((found.a, found.b, found.c, found.d), *noise)

    return identify


def era() -> Method:
    import control

    def identify(drive: np.ndarray, response: np.ndarray, order: int, _horizon: int) -> Matrices:
        taps = np.asarray(control.markov(response.T, drive.T, TAPS))
        taps = taps.reshape(response.shape[1], drive.shape[1], TAPS)
        found, _ = control.eigensys_realization(taps, order, TAPS // 2, TAPS // 2 - 1)
        return {name: np.asarray(getattr(found, name), float) for name in "ABCD"}

    return identify


def pysid_armax() -> Method:
    from pysid.identification.pemethod import armax

    def identify(drive: np.ndarray, response: np.ndarray, order: int, _horizon: int) -> Matrices:
        found = armax(order, order - 1, order, 1, drive, response)
        return companion(*(np.ravel(part[0, 0]) for part in (found.A, found.B, found.C)))

    return identify


METHODS: dict[str, Callable[[], Method]] = {
    "ours": partial(ours, "moesp", refined=False),
    "ours, n4sid": partial(ours, "n4sid", refined=False),
    "ours, horizon left to it": own_horizon,
    "ours, all left to it": own_all,
    "ours, refined": partial(ours, "moesp", refined=True),
    "SLICOT N4SID": partial(slicot, "N"),
    "SLICOT N4SID, by QR": partial(slicot, "N", compression="Q"),
    "SLICOT N4SID, its own K": partial(slicot, "N", gain="K"),
    "SLICOT MOESP": partial(slicot, "M"),
    "SIPPY N4SID": partial(sippy, "N4SID"),
    "SIPPY MOESP": partial(sippy, "MOESP"),
    "SIPPY CVA": partial(sippy, "CVA"),
    "SIPPY PARSIM-K": partial(sippy, "PARSIM-K"),
    "SIPPY PARSIM-S": partial(sippy, "PARSIM-S"),
    "SIPPY ARMAX": sippy_armax,
    "nfoursid": nfoursid,
    "python-control ERA": era,
    "pysid ARMAX": pysid_armax,
}

PROPOSALS: dict[str, Callable[[], Proposal]] = {
    "ours": our_order,
    "SLICOT, largest gap": slicot_order,
    "SIPPY N4SID, AIC": sippy_order,
}


def _sippy(method: str) -> Callable[..., Any]:
    from sippy_unipi import system_identification

    def run(drive: np.ndarray, response: np.ndarray, **settings: Any) -> Any:
        with contextlib.redirect_stdout(io.StringIO()):  # it prints the order it finds
            return system_identification(response.T, drive.T, method, tsample=1 / RATE, **settings)

    return run


def _accept(routine: str, info: int) -> None:
    if info:
        raise RuntimeError(f"{routine} gave INFO = {info}")


def _with_gain(
    system: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    state: np.ndarray,
    output: np.ndarray,
    both: np.ndarray,
) -> Matrices:
    """Add the Kalman gain that covariances of state noise, output noise and both together determine."""
    transition, _, outlet, _ = system
    spread = solve_discrete_are(transition.T, outlet.T, state, output, s=both)
    innovation = outlet @ spread @ outlet.T + output
    gain = np.linalg.solve(innovation, (transition @ spread @ outlet.T + both).T).T
    return dict(zip("ABCDK", (*system, gain), strict=True))


def companion(denominator: np.ndarray, drive: np.ndarray, noise: np.ndarray) -> Matrices:
    """Return a(q) y = b(q) u + c(q) e as a state space; coefficients by rising delay, a and c monic."""
    order = max(len(denominator), len(drive), len(noise)) - 1
    a, b, c = (np.pad(each, (0, order + 1 - len(each))) for each in (denominator, drive, noise))
    transition = np.eye(order, k=1)
    transition[:, 0] = -a[1:]
    return {
        "A": transition,
        "B": (b[1:] - a[1:] * b[0])[:, None],
        "C": np.eye(1, order),
        "D": np.array([[b[0]]]),
        "K": (c[1:] - a[1:])[:, None],
    }
