"""Random values of a sample: numbers of the unit cube by method and seed, made into values by their distributions."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from vssea_core.batch.document import LogUniform, Normal, Sample, Uniform

Numbers = NDArray[np.float64]


def unit_cube(sample: Sample, seed: int, place: int) -> Numbers:
    """Return the sample's points (count, draws) in the unit cube; `place` tells the samples of one batch apart."""
    width, stream = len(sample.draws), np.random.Generator(np.random.Philox(np.random.SeedSequence([seed, place])))
    match sample.method:
        case "random":
            return stream.random((sample.count, width))
        case "sobol":
            power = max(0, math.ceil(math.log2(sample.count)))  # the first points of a whole net
            return np.asarray(qmc.Sobol(width, rng=stream).random_base2(power))[: sample.count]
        case "latin_hypercube":
            return np.asarray(qmc.LatinHypercube(width, rng=stream).random(sample.count))


def drawn(distribution: Uniform | LogUniform | Normal, unit: Numbers) -> Numbers:
    """Return values of a distribution at numbers (n,) between 0 and 1, by the inverse of its cumulative distribution."""
    low, high = ends_of(distribution)
    match distribution:
        case Uniform():
            values = low + (high - low) * unit
        case LogUniform():
            values = np.exp(math.log(low) + (math.log(high) - math.log(low)) * unit)
        case Normal(mean=mean, std=std, within=within):
            edge = float(ndtr(-within))
            values = mean + std * np.clip(ndtri(edge + (1.0 - 2.0 * edge) * unit), -within, within)
    return np.clip(values, low, high)  # rounding may lead beyond an end


def drawn_whole(distribution: Uniform | LogUniform | Normal, unit: Numbers, factor_of: int = 1) -> Numbers:
    """Return whole numbers of a distribution, its values times `factor_of`; uniform ones are each as likely as the others.

    Raises ValueError if there are none between its ends.
    """
    low, high = sorted(factor_of * end for end in ends_of(distribution))
    first, last = float(np.ceil(low)), float(np.floor(high))
    if first > last:
        raise ValueError(f"no whole number lies between {low:g} and {high:g}")
    if isinstance(distribution, Uniform):
        return np.clip(first + np.floor(unit * (last - first + 1.0)), first, last)
    return np.clip(np.rint(factor_of * drawn(distribution, unit)), first, last)


def ends_of(distribution: Uniform | LogUniform | Normal) -> tuple[float, float]:
    """Return the least and the largest value of a distribution."""
    match distribution:
        case Normal(mean=mean, std=std, within=within):
            return mean - std * within, mean + std * within
        case _:
            return distribution.low, distribution.high
