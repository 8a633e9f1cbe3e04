"""What a multisine found, drawn: its levels beside noise and distortion, line by line."""

import numpy as np
from matplotlib.figure import Figure

from calibration.multisine_estimate import Levels
from rigkit.figure_style import COLOURS
from rigkit.report import Plot, Section, Table

DRAWN = (
    ("preload", "preload and its overtones", COLOURS[4]),
    ("response", "response to the multisine", COLOURS[0]),
    ("even", "even bins: distortion and noise", COLOURS[1]),
    ("odd", "odd bins left out: distortion and noise", COLOURS[3]),
    ("noise", "silence: noise", COLOURS[6]),
)
BANDS = ((0.0, 100.0), (100.0, 200.0), (200.0, 400.0), (400.0, np.inf))
"""Hz."""
LEVEL_HEAD = ("band, response", "multisine, dB", "even distortion", "odd distortion", "noise")


def levels_section(levels: Levels, tones: np.ndarray) -> Section:
    """Put the section of a multisine's report together: `tones` (tones,), Hz, were measured again."""
    text = (
        "The multisine excites odd bins only, and one in five of those is left out. Even bins show the distortion of "
        f"even order of {_emitted(levels)}, the odd ones left out the distortion of odd order. "
        "Distortion on the excited bins is as strong; it is averaged over records and bins and is part of the "
        "variance."
    )
    if len(tones):
        named = ", ".join(f"{tone:g}" for tone in tones)
        text += f"\n\nLeast certain, and measured again by a stepped sine: {named} Hz."
    caption = "Rms amplitude of a bin, averaged over 4 Hz, in m/s² per bin."
    return Section("Noise and distortion", text, (Plot(_drawn(levels), caption),), (level_table(levels),))


def _emitted(levels: Levels) -> str:
    """Say what was played: quiet measurements have no preload."""
    return "preload and multisine" if levels.preload.any() else "the multisine"


def level_table(levels: Levels) -> Table:
    """Return levels by band and response: the multisine's in dB re 1 m/s^2, the others in dB re that."""
    rows = []
    for low, high in BANDS:
        inside = (levels.frequency >= low) & (levels.frequency < high)
        if not inside.any():
            continue
        for output in range(levels.response.shape[1]):
            size = {
                name: np.sqrt(np.mean(getattr(levels, name)[inside, output] ** 2))
                for name in ("response", "even", "odd", "noise")
            }
            band = levels.frequency[inside]
            rows.append(
                (
                    f"{band[0]:g} to {band[-1]:g} Hz, {output + 1}",
                    f"{20 * np.log10(size['response']):.1f}",
                    *(f"{_over(size[name], size['response']):.1f}" for name in ("even", "odd", "noise")),
                )
            )
    return Table(LEVEL_HEAD, tuple(rows))


def _over(size: float, reference: float) -> float:
    return float(20 * np.log10(max(size / reference, 1e-12)))


def _drawn(levels: Levels) -> Figure:
    outputs = levels.response.shape[1]
    figure = Figure(figsize=(8.0, 3.0 * outputs + 0.8))
    axes = figure.subplots(outputs, 1, sharex=True, squeeze=False)[:, 0]
    for output, each in enumerate(axes):
        for name, label, colour in DRAWN if levels.preload.any() else DRAWN[1:]:
            size = np.maximum(getattr(levels, name)[:, output], 1e-12)
            each.plot(levels.frequency, 20 * np.log10(size), color=colour, linewidth=0.9, label=label)
        each.set(title=f"response {output + 1}", ylabel="dB re 1 m/s²")
    axes[0].legend(loc="lower center", bbox_to_anchor=(0.5, 1.12), ncols=2)
    axes[-1].set_xlabel("Hz")
    return figure
