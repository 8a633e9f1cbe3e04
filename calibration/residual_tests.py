"""Whether residuals are white, and whether they still hold something of the drive."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

LAGS = 25
"""Correlations looked at where the caller does not say."""
_DEVIATIONS = 2.5758
"""Of a normal variable: exceeded, on either side, one time in a hundred."""


@dataclass(frozen=True)
class Whiteness:
    """The correlations of residuals with their own past.

    Parameters
    ----------
    correlation : array, shape (lags, p, p), 1
        Of output i now with output j `lag` samples ago, from lag 1 on; 1 would be all of it.
    bound : float, 1
        What one correlation of white residuals exceeds one time in a hundred.
    statistic : float, 1
        The portmanteau sum over all of them.
    probability : float, 0 to 1
        Of so large a sum if the residuals were white.

    Source
    ------
    Hosking 1980, "The multivariate portmanteau statistic", J. Am. Stat. Assoc. 75, 602-608; for one output that is
    Ljung and Box 1978.
    """

    correlation: np.ndarray
    bound: float
    statistic: float
    probability: float

    @property
    def outside(self) -> float:
        """Part of the correlations beyond the bound; 0.01 is what chance gives."""
        return float(np.mean(np.abs(self.correlation) > self.bound))


@dataclass(frozen=True)
class CrossCorrelation:
    """The correlations of residuals with the drive.

    Parameters
    ----------
    lag : array of int, shape (lags,), samples
        From negative ones, where a correlation is the mark of feedback, to positive ones, where it is the mark of a
        response that the model leaves out.
    correlation : array, shape (lags, p, m), 1
        Of output i now with input j `lag` samples ago.
    bound : array, shape (p, m), 1
        What one correlation with an independent drive exceeds one time in a hundred.

    Source
    ------
    Ljung 1999, System Identification, 2nd ed., section 16.6: the variance of a correlation with an independent drive is
    the sum over all lags of the product of both autocorrelations, over N.
    """

    lag: np.ndarray
    correlation: np.ndarray
    bound: np.ndarray

    @property
    def outside(self) -> float:
        """Part of the correlations from lag 0 on beyond their bound; 0.01 is what chance gives, 0 where none are."""
        return float(np.mean(np.abs(self.correlation[self.lag >= 0]) > self.bound)) if self.bound.size else 0.0


def whiteness(residuals: Sequence[np.ndarray], lags: int = LAGS, fitted: int = 0) -> Whiteness:
    """Test residuals for whiteness, over one or more records.

    Parameters
    ----------
    residuals : sequence of arrays, each of shape (N, p), any unit
    lags : int, samples
    fitted : int
        Coefficients of the noise model that were fitted to these very residuals; 0 on fresh data.

    Raises
    ------
    ValueError : a record no longer than the lags, or an output without residual.
    """
    from scipy.special import chdtrc  # takes as long to import as all the rest

    centred = _centred(residuals, lags, "residual")
    count = sum(len(record) for record in centred)
    covariances = _mean([_covariances(record, record, lags) for record in centred], count)
    scale = np.sqrt(np.diag(covariances[0]))
    correlation = covariances[1:] / np.outer(scale, scale)
    inverse = np.linalg.pinv(covariances[0] / np.outer(scale, scale), hermitian=True)
    powers = np.einsum("kij,jl,kml,mi->k", correlation, inverse, correlation, inverse)
    statistic = float(count**2 * np.sum(powers / (count - np.arange(1, lags + 1))))
    freedom = max(1, lags * len(scale) ** 2 - fitted)
    return Whiteness(correlation, _DEVIATIONS / np.sqrt(count), statistic, float(chdtrc(freedom, statistic)))


def cross_correlation(
    residuals: Sequence[np.ndarray], drives: Sequence[np.ndarray], lags: int = LAGS
) -> CrossCorrelation:
    """Correlate residuals with the drive, over one or more records.

    Parameters
    ----------
    residuals : sequence of arrays, each of shape (N, p), any unit
    drives : sequence of arrays, each of shape (N, m), any unit
        One that never changes goes with nothing.
    lags : int, samples
        On either side of zero.

    Raises
    ------
    ValueError : a record no longer than the lags, or an output without residual.
    """
    late, early = _centred(residuals, lags, "residual"), _centred(drives, lags, "drive", may_rest=True)
    count = sum(len(record) for record in late)
    after = _mean([_covariances(one, other, lags) for one, other in zip(late, early, strict=True)], count)
    before = _mean([_covariances(other, one, lags) for one, other in zip(late, early, strict=True)], count)
    own = [_mean([_own(record, lags) for record in records], count) for records in (late, early)]
    scale = np.sqrt(np.outer(own[0][0], own[1][0]))
    scale[scale == 0] = np.inf  # a drive at rest goes with nothing
    both = np.concatenate([before[:0:-1].transpose(0, 2, 1), after]) / scale
    shapes = [power / np.where(power[0] > 0, power[0], 1.0) for power in own]
    spread = 1 + 2 * np.einsum("ki,kj->ij", shapes[0][1:], shapes[1][1:])
    bound = _DEVIATIONS * np.sqrt(np.maximum(spread, 0.1) / count)
    return CrossCorrelation(np.arange(-lags, lags + 1), both, bound)


def _centred(records: Sequence[np.ndarray], lags: int, name: str, may_rest: bool = False) -> list[np.ndarray]:
    """Take away the mean over all records, and refuse what has no correlations."""
    shortest = min(len(record) for record in records)
    if not shortest > lags:
        raise ValueError(f"a {name} has {shortest} samples, must have more than the {lags} lags")
    mean = np.mean(np.concatenate(records), axis=0)
    centred = [record - mean for record in records]
    still = ~(np.sum([np.sum(record**2, axis=0) for record in centred], axis=0) > 0)
    if still.any() and not may_rest:
        raise ValueError(f"{name} {int(np.argmax(still)) + 1} never changes: it has no correlations")
    return centred


def _covariances(late: np.ndarray, early: np.ndarray, lags: int) -> np.ndarray:
    """Return the sums over n of late[n] early[n - lag]', shape (lags + 1, late's width, early's width)."""
    return np.stack([late[lag:].T @ early[: len(early) - lag] for lag in range(lags + 1)])


def _own(record: np.ndarray, lags: int) -> np.ndarray:
    """Return the sums over n of x[n] x[n - lag] of each signal, shape (lags + 1, width)."""
    return np.stack([np.sum(record[lag:] * record[: len(record) - lag], axis=0) for lag in range(lags + 1)])


def _mean(sums: list[np.ndarray], count: int) -> np.ndarray:
    """Add what the records give, over the number of all samples."""
    mean: np.ndarray = np.sum(sums, axis=0) / count
    return mean
