"""Seeded noise: the published generator, normal and independent numbers, and a smooth function of time made of them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal, stats

from vssea_core.signals.disturbances import INSTANTS
from vssea_core.signals.noise import four_normals, normal, philox
from vssea_core.signals.smooth_noise import SPACING_BANDWIDTH, noise_and_rates, noise_at, noise_of_step

KNOWN = {  # Random123's kat_vectors: counter and key, words
    "zeros": ([0] * 6, "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
    "ones": ([0xFFFFFFFF] * 6, "408f276d 41c83b0e a20bc7c6 6d5451fd"),
    "digits of pi": (
        [0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344, 0xA4093822, 0x299F31D0],
        "d16cfe09 94fdcceb 5001e420 24126ea1",
    ),
}


@pytest.mark.parametrize(("given_words", "expected"), KNOWN.values(), ids=KNOWN)
def test_the_generator_gives_the_published_words(given_words: list[int], expected: str) -> None:
    words = philox(*(np.uint64(word) for word in given_words))
    assert " ".join(f"{int(word):08x}" for word in words) == expected


def drawn(seed: int, stream: int, count: int = 20_000) -> np.ndarray:
    return np.array([four_normals(seed, stream, i) for i in range(count)])


def test_the_numbers_are_standard_normal() -> None:
    values = drawn(3, 1).ravel()
    assert abs(values.mean()) < 4.0 / np.sqrt(len(values))
    assert abs(values.var() - 1.0) < 4.0 * np.sqrt(2.0 / len(values))
    assert stats.kstest(values, "norm").pvalue > 1e-3
    assert abs(stats.kurtosis(values)) < 4.0 * np.sqrt(24.0 / len(values))


def test_the_four_of_an_index_neighbours_streams_and_seeds_are_independent() -> None:
    base = drawn(3, 1)
    others = [base[:, 1], base[:, 2], base[:, 3], np.roll(base[:, 0], 1), drawn(3, 2)[:, 0], drawn(4, 1)[:, 0]]
    for other in others:
        for power in (1, 2):
            assert abs(np.corrcoef(base[:, 0] ** power, other**power)[0, 1]) < 4.0 / np.sqrt(len(base))


@given(
    seed=st.integers(0, 2**31 - 1),
    stream=st.integers(0, 2000),
    indices=st.lists(st.integers(-(2**40), 2**40), max_size=8),
)
@settings(deadline=None, max_examples=40)
def test_a_number_depends_on_seed_stream_and_index_only(seed: int, stream: int, indices: list[int]) -> None:
    there = [four_normals(seed, stream, i) for i in indices]
    back = [four_normals(float(seed), float(stream), i) for i in reversed(indices)][::-1]
    assert there == back
    assert [normal(seed, stream, i) for i in indices] == [four[0] for four in there]


def test_half_of_the_index_is_not_lost() -> None:
    assert normal(1, 1, 5) != normal(1, 1, 5 + 2**32)


def test_smooth_noise_has_unit_variance_at_and_between_nodes() -> None:
    for share in (0.0, 0.2, 0.5):
        values = np.array([noise_at(1.0, 9, 300, k + share) for k in range(0, 80_000, 4)])
        assert abs(values.var() - 1.0) < 4.0 * np.sqrt(2.0 / len(values)), share
        assert stats.kstest(values, "norm").pvalue > 1e-3


def test_the_spectrum_is_flat_and_down_by_3_db_at_the_bandwidth() -> None:
    rate, bandwidth = 100.0, 5.0
    values = np.array([noise_at(bandwidth / SPACING_BANDWIDTH, 5, 256, k / rate) for k in range(400_000)])
    frequencies, density = signal.welch(values, rate, nperseg=2048)
    low = density[(frequencies > 0.3) & (frequencies < 1.0)].mean()
    at = density[np.abs(frequencies - bandwidth) < 0.25].mean()
    assert at / low == pytest.approx(0.5, rel=0.08)
    assert density[frequencies > 6.0 * bandwidth].max() < 1e-3 * low


@given(time=st.floats(0.0, 1000.0), h=st.floats(1e-5, 5e-3), bandwidth=st.floats(0.01, 100.0))
@settings(deadline=None, max_examples=60)
def test_the_noise_of_a_step_is_that_of_its_instants(time: float, h: float, bandwidth: float) -> None:
    per_spacing = bandwidth / SPACING_BANDWIDTH
    found = noise_of_step(per_spacing, 7.0, 512.0, time, h, INSTANTS)
    assert found == tuple(noise_at(per_spacing, 7.0, 512.0, time + share * h) for share in INSTANTS)


def test_the_rates_of_the_noise_are_those_of_its_values() -> None:
    times, h = np.linspace(0.05, 3.0, 400), 1e-4
    value, rate, acceleration = noise_and_rates(10.0, 2, 256, times)
    assert np.allclose(value, [noise_at(10.0, 2, 256, t) for t in times], rtol=1e-12, atol=1e-12)
    before, after = (noise_and_rates(10.0, 2, 256, times + shift) for shift in (-h, h))
    assert np.allclose((after[0] - before[0]) / (2.0 * h), rate, atol=1e-3 * np.abs(rate).max())
    assert np.allclose((after[1] - before[1]) / (2.0 * h), acceleration, atol=3e-3 * np.abs(acceleration).max())
