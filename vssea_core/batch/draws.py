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
    match distribution:
        case Uniform(low=low, high=high):
            return low + (high - low) * unit
        case LogUniform(low=low, high=high):
            return np.asarray(low * np.exp(math.log(high / low) * unit))
        case Normal(mean=mean, std=std, within=within):
            edge = float(ndtr(-within))
            return np.asarray(mean + std * np.clip(ndtri(edge + (1.0 - 2.0 * edge) * unit), -within, within))
