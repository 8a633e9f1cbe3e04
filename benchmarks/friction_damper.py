"""Joint extraction on a measured friction damper whose linkage has backlash: the nearest public relative of a joint.

`python -m benchmarks.friction_damper`, seconds; the data are Lehigh's (Coble et al. 2022), see ../shared/data.

There the friction sits behind the play, not beside the spring as in a gear.  So two readings are shown: the whole
loop, of which the extraction must say that there is no spring and no backlash about zero force, only friction; and the
flanks after the reversals, where the linkage unloads, crosses its play and loads again before anything slides: each is
shifted to the middle of its own play, and all are put together to a map to and fro.
"""

import json
from pathlib import Path

import numpy as np

from calibration.joint_clamping.extraction import extract
from calibration.joint_clamping.torque_map import TorqueMap
from tests.shared_data import DATA

FILES = ("dataset-1__1Hz70lbtension.json", "dataset-2__2Hz36lbtension0.5amplitude.json")
RATE = 1024.0
INCH, KIP = 0.0254, 4448.2216
SLIDES = 0.6
"""Of the force at which it slides: beyond that a flank is over."""
SLACK = 0.12
"""Of the same: what counts as no force."""
LARGE = 0.8
"""Of the largest span between two reversals; smaller ones come while the machine starts."""


def loop(file: Path) -> TorqueMap:
    """Return displacement and friction force of a data set, m and N in place of rad and N m."""
    data = np.array(json.loads(file.read_text())["data"])
    return TorqueMap(INCH * data[:, 1], KIP * data[:, 2], RATE)


def flanks(whole: TorqueMap) -> TorqueMap:
    """Return the flanks after large reversals as one map, each shifted to the middle of its slack part."""
    force, place = whole.torque, whole.angle
    ends = np.flatnonzero(np.diff(np.sign(_smooth(np.diff(place), 15)))) + 1
    spans = np.abs(np.diff(place[ends]))
    slides = float(np.quantile(np.abs(force), 0.6))
    parts = []
    for start, stop, span in zip(ends[:-1], ends[1:], spans, strict=True):
        sign = np.sign(place[stop] - place[start])
        over = np.flatnonzero(sign * force[start:stop] > SLIDES * slides)
        begun = np.flatnonzero(sign * force[start:stop] < -SLIDES * slides)
        if span < LARGE * spans.max() or not len(over) or not len(begun):
            continue
        first = begun[begun < over[0]].max(initial=0)
        part = slice(start + first, start + over[0])
        slack = np.abs(force[part]) < SLACK * slides
        parts.append((place[part] - place[part][slack].mean(), force[part]))
    return TorqueMap(np.concatenate([x for x, _ in parts]), np.concatenate([f for _, f in parts]), RATE)


def _smooth(values: np.ndarray, width: int) -> np.ndarray:
    return np.convolve(values, np.ones(width) / width, "same")


def main() -> None:
    if not DATA.is_dir():
        print(f"{DATA} is not here: nothing to read")
        return
    for name in FILES:
        whole = loop(DATA / "friction_damper" / name)
        print(f"{name[:9]} whole loop: {_said(whole)}")
        print(f"{name[:9]} flanks: {_said(flanks(whole))}")


def _said(joint: TorqueMap) -> str:
    found = extract(joint)
    play = f"{1e3 * found.backlash.value:.2f} ± {1e3 * found.backlash.reach * found.backlash.error:.2f} mm"
    if not found.has_backlash:
        play = f"not significant (< {1e3 * found.backlash_bound:.1f} mm)"
    stiff = ", ".join(
        f"{1e-6 * each.value:.2f} ± {1e-6 * each.reach * each.error:.2f}" for each in (found.k_plus, found.k_minus)
    )
    friction = f"{1e-3 * found.friction.value:.2f} ± {1e-3 * found.friction.reach * found.friction.error:.2f}"
    return f"play {play}, k {stiff} kN/mm, friction {friction} kN, {1e-3 * found.residual:.2f} kN left"


if __name__ == "__main__":
    main()
