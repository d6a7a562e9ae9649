"""Spectra of natural wind against their integrals and closed forms, samples against their spectra."""

from itertools import product

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.signal import welch
from scipy.special import gamma, kv
from scipy.stats import kstest

from rainwind.errors import InputError
from rainwind.physics.turbulence import COMPONENTS, SPECTRA, share_below, spectrum_at, turbulent_samples

LENGTH, MEAN = 80.0, 10.0
ALL = list(product(SPECTRA, COMPONENTS))


@pytest.mark.parametrize(("spectrum", "component"), ALL)
def test_the_variance_is_one_and_its_share_the_integral(spectrum, component):
    own = (spectrum, component, LENGTH, MEAN)
    for upper in (0.003, 0.1, 4.0):
        found = quad(lambda f: spectrum_at(f, *own), 0, upper, epsabs=1e-12, limit=200)[0]
        assert share_below(upper, *own) == pytest.approx(found, abs=1e-10)
    assert share_below(1e8, *own) == pytest.approx(1.0, abs=1e-5)
    assert share_below(0.0, *own) == 0.0
    assert spectrum_at(0.0, *own) == pytest.approx(4 * LENGTH / MEAN)


def test_formulas_as_printed():
    f = np.geomspace(1e-4, 10, 50)
    x = f * LENGTH / MEAN
    # EN 1991-1-4, annex B: its L(z) is ours over 1.7
    en = 6.8 * (x / 1.7) / (1 + 10.2 * x / 1.7) ** (5 / 3)
    np.testing.assert_allclose(f * spectrum_at(f, "kaimal", "along", LENGTH, MEAN), en, rtol=1e-12)
    # ESDU 85020, with constants of three digits
    along = 4 * x / (1 + 70.8 * x**2) ** (5 / 6)
    upward = 4 * x * (1 + 755.2 * x**2) / (1 + 283.2 * x**2) ** (11 / 6)
    np.testing.assert_allclose(f * spectrum_at(f, "von karman", "along", LENGTH, MEAN), along, rtol=5e-4)
    np.testing.assert_allclose(f * spectrum_at(f, "von karman", "vertical", LENGTH, MEAN), upward, rtol=5e-4)


@pytest.mark.parametrize(("spectrum", "component"), ALL)
@pytest.mark.parametrize("count", [1000, 1001])
def test_every_record_has_the_variance_of_its_band(spectrum, component, count):
    own = (spectrum, component, LENGTH, MEAN)
    x = turbulent_samples(count, 0.25, (5, 0), *own)
    low, high = share_below(np.array([0.5, (count - 1) // 2 + 0.5]) / (count * 0.25), *own)
    assert x.shape == (count,)
    assert x.mean() == pytest.approx(0.0, abs=1e-14)
    assert x.var() == pytest.approx(high - low, rel=1e-12)


@pytest.mark.parametrize(("spectrum", "component"), ALL)
def test_welch_s_estimate_lies_in_its_band_around_the_spectrum(spectrum, component):
    own = (spectrum, component, LENGTH, MEAN)
    x = turbulent_samples(2**17, 0.1, (7, 1), *own)
    f, estimate = welch(x, fs=10.0, nperseg=2**12)
    ratio = (estimate / spectrum_at(f, *own))[3:-40]
    # 63 half-overlapping Hann segments: relative deviation of one estimate about (11/9 / 32)^0.5 = 0.195
    single = np.sqrt(11 / 9 / 32)
    assert np.mean(np.abs(ratio - 1) < 4 * single) > 0.995
    for block in np.array_split(ratio, 12):
        # neighbouring frequencies of a Hann window go together: a third of them counts
        assert abs(block.mean() - 1) < 4 * single / np.sqrt(block.size / 3)


def test_autocorrelation_of_a_von_karman_record():
    # Bessel-function form of the same spectrum; its integral over time is L / U
    def exact(tau):
        zeta = np.sqrt(np.pi) * gamma(5 / 6) / gamma(1 / 3) * tau * MEAN / LENGTH
        return 2 ** (2 / 3) / gamma(1 / 3) * zeta ** (1 / 3) * kv(1 / 3, zeta)

    assert quad(exact, 0, 400, limit=200)[0] == pytest.approx(LENGTH / MEAN, rel=1e-6)
    dt, count = 0.1, 2**17
    x = turbulent_samples(count, dt, (2, 0), "von karman", "along", LENGTH, MEAN)
    correlation = np.fft.irfft(np.abs(np.fft.rfft(x)) ** 2, count) / count
    lags = np.array([10, 40, 80, 160, 320])
    # what the band leaves out: 0.0013 of the variance below half a wave in the record, 0.006 above the sampling rate
    assert correlation[lags] == pytest.approx(exact(lags * dt), abs=0.005)


def test_values_are_gaussian():
    # one value of each of 1000 records, which are independent
    first = [
        turbulent_samples(2048, 0.5, (seed, 0), "kaimal", "along", LENGTH, MEAN)[0] for seed in range(1000)
    ]
    low, high = share_below(np.array([0.5, 1023.5]) / 1024, "kaimal", "along", LENGTH, MEAN)
    assert kstest(np.array(first) / np.sqrt(high - low), "norm").pvalue > 0.01


def test_seeds():
    own = (64, 0.5)
    rest = ("kaimal", "along", LENGTH, MEAN)
    one = turbulent_samples(*own, (1, 0), *rest)
    assert np.array_equal(one, turbulent_samples(*own, (1, 0), *rest))
    for other in ((2, 0), (1, 1)):
        assert abs(np.corrcoef(one, turbulent_samples(*own, other, *rest))[0, 1]) < 0.9
    # PCG64's numbers do not depend on the machine: a wind of a report can be made again
    assert one[:3] == pytest.approx([-0.3713492413711075, -0.478749351855047, 0.20013995037138788], abs=1e-12)


@pytest.mark.parametrize(
    ("spectrum", "component", "words"),
    [
        ("kaiml", "along", "spectrum = 'kaiml' is not known"),
        ("kaimal", "up", "component = 'up' is not known"),
    ],
)
def test_names_that_are_refused(spectrum, component, words):
    with pytest.raises(InputError, match=words):
        spectrum_at(1.0, spectrum, component, 1.0, 1.0)
    with pytest.raises(InputError, match=words):
        share_below(1.0, spectrum, component, 1.0, 1.0)
