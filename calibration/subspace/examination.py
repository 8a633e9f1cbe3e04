"""Records before there is a model of them: what can be told from them, and what stands in the way."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from calibration.gaps import without_gaps
from calibration.one_thread import on_one_thread
from calibration.records import sides_of
from calibration.subspace.delays import Delays, delays
from calibration.subspace.excitation import MOST, persistence, repeated
from calibration.subspace.feedback import Feedback, feedback
from calibration.subspace.naming import by_name
from calibration.subspace.nonlinearity import Nonlinearity, nonlinearity
from calibration.subspace.outliers import outlier_notes, treated
from calibration.subspace.signals import signals


@dataclass(frozen=True)
class Examination:
    """Of records.

    Parameters
    ----------
    samples, records : int
        Without what is missing.
    persistence : int
        Order of which the inputs excite persistently, see `excitation.persistence`.
    same : (int, int) or None
        Two inputs, counted from 0, that are one signal.
    delays : Delays or None
        What each output hears of each input; None where records are too short, or inputs too poor, to tell.
    feedback : Feedback
        Whether inputs follow from outputs.
    nonlinearity : Nonlinearity
        Whether squares and cubes tell of the outputs.
    outliers : tuple of arrays of bool, shape (N, p)
        Samples of outputs that are far off.
    names : (tuple of str, tuple of str)
        Of inputs and outputs; empty where nobody gave any.
    """

    samples: int
    records: int
    persistence: int
    same: tuple[int, int] | None
    delays: Delays | None
    feedback: Feedback
    nonlinearity: Nonlinearity
    outliers: tuple[np.ndarray, ...]
    names: tuple[tuple[str, ...], tuple[str, ...]] = ((), ())

    @property
    def sentences(self) -> tuple[str, ...]:
        """Verdicts, what is well as well as what is not."""
        return by_name(self._verdicts(), *self.names)

    def __str__(self) -> str:
        """Return them a line each."""
        return "\n".join(self.sentences)

    def _verdicts(self) -> Iterator[str]:
        yield f"{self.samples} samples in {self.records} record{'s' * (self.records > 1)}"
        if self.same is not None:
            first, second = (each + 1 for each in self.same)
            yield f"inputs {first} and {second} are the same signal: their responses are not distinguishable"
        elif len(self.feedback.share) and self.persistence < MOST:
            yield (
                f"inputs excite persistently of order {self.persistence}: enough for {self.persistence // 2} states, "
                "and of more much would be guessed"
            )
        elif len(self.feedback.share):
            yield f"inputs excite persistently of order {MOST} or more"
        if self.delays is not None:
            yield from self._heard(self.delays)
        elif len(self.feedback.share):
            yield "the response to the inputs cannot be determined: records are too short, or the excitation too poor"
        yield from self.feedback.sentences
        if not self.feedback.inputs:
            yield from self.nonlinearity.sentences
        yield from outlier_notes(self.outliers)

    def _heard(self, found: Delays) -> Iterator[str]:
        for number, each in enumerate(found.samples.T):
            at = [f"{late} at output {output + 1}" for output, late in enumerate(each) if late >= 0]
            if at:
                yield f"input {number + 1} shows in the outputs after so many samples: {', '.join(at)}"
        yield from found.unheard


@on_one_thread
def examine(u: Any, y: Any) -> Examination:
    """Look at records before anything is identified from them.

    Parameters
    ----------
    u : array, shape (N, m) or (N,), list, pandas or polars table, or a sequence of such, the inputs' units
        As of `identify`.
    y : array, shape (N, p) or (N,), list or table as `u`, or a sequence of such, the outputs' units

    Raises
    ------
    ValueError : records that are unusable, or a signal that never changes.

    Examples
    --------
    >>> u = np.random.default_rng(1).standard_normal(800)
    >>> y = 0.5 * np.roll(u, 4) + 0.1 * np.random.default_rng(2).standard_normal(800)
    >>> print(examine(u, y))
    800 samples in 1 record
    inputs excite persistently of order 40 or more
    input 1 shows in the outputs after so many samples: 4 at output 1
    """
    inputs, outputs = sides_of(u, y)
    drives, responses = without_gaps(inputs.records, outputs.records)
    responses, off = treated(drives, responses, "replace")
    data = signals(drives, responses, has_mean=True)
    same = repeated(drives)
    return Examination(
        data.samples,
        len(data.drives),
        persistence(data.drives),
        same,
        None if same else delays(data.drives, data.responses),
        feedback(data.drives, data.responses),
        nonlinearity(data.drives, data.responses),
        tuple(off),
        (inputs.names, outputs.names),
    )
