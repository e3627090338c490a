"""Power spectra under random inputs: closed forms, and simulations with spectra by Welch's method."""

import warnings

import numpy as np
import pytest
from scipy.signal import csd, lsim, welch

import parflex as pf
from published_hexapods import cubic

K, L, M, INERTIA, C = 1e5, 0.4, 10.0, (0.1, 0.1, 0.2), 100.0
STIFF, DAMPED = 2 * K, 2 * C  # of a cubic hexapod along each axis (Preumont)
OMEGA_0 = np.sqrt(STIFF / M)
ZETA = DAMPED / (2 * np.sqrt(STIFF * M))


@pytest.fixture(scope="module")
def hexapod():
    """A cubic hexapod with legs of 1e-7 kg: model, equilibrium, forces and where its centre is."""
    robot, offset = cubic(1e-7, K, L, M, INERTIA, C)
    model = pf.Model(robot)
    return model, *model.equilibrium(*robot.home_pose), offset


@pytest.fixture(scope="module")
def frf(hexapod):
    """The compliance of the centre, fine about its resonances at 22.5 Hz and above."""
    model, state, forces, offset = hexapod
    omega = OMEGA_0 * np.concatenate([np.geomspace(1e-4, 0.3, 400), np.geomspace(0.301, 60, 20000)])
    return pf.compliance(model.linearise(state, forces), 0, offset)(omega)


def test_white_noise_on_an_oscillator(frf):
    """σ² = π S₀ / (k c) = π S₀ ω₀ / (2 ζ k²), S₀ two-sided per rad/s (Crandall and Mark, ch. 2); here S₀ =
    G / 4π of a one-sided G per Hz. The band to 60 ω₀ leaves 4ζ / (3π 60³) of it: 4e-7."""
    G = 3.0  # N²/Hz
    label = str(frf.input.values[2])
    found = pf.power_spectrum(frf, {label: G})
    variance = np.pi * (G / (4 * np.pi)) * OMEGA_0 / (2 * ZETA * STIFF**2)
    assert variance == pytest.approx(G / (4 * STIFF * DAMPED), rel=1e-12)
    assert float(found.rms[2]) ** 2 == pytest.approx(variance, rel=2e-5)  # trapezoids leave 9e-6
    assert np.allclose(found.psd.values[2], G * np.abs(frf.values[2, 2]) ** 2)
    assert float(found.cumulative_rms[2, -1]) == float(found.rms[2])
    assert np.all(np.diff(found.cumulative_rms.values) >= 0)
    assert float(found.rms_by_input.sel(input=label)[2]) == pytest.approx(float(found.rms[2]), rel=1e-12)
    assert list(found.psd_units.values[[0, 3]]) == ["(m)^2/Hz", "(rad)^2/Hz"]
    half, root = np.searchsorted(found.omega.values, OMEGA_0), np.sqrt(1 - ZETA**2)
    below = 0.5 + ZETA / (2 * np.pi * root) * np.log((1 + root) / (1 - root))  # ch. 2: the share below ω₀
    assert float(found.cumulative_rms[2, half]) ** 2 == pytest.approx(variance * below, rel=2e-2)


def test_inputs_that_are_uncorrelated_add_their_powers(frf):
    """As an array of each, as labels, and as a diagonal cross-spectral matrix."""
    w = frf.sizes["omega"]
    each = np.outer([1.0, 2.0, 3.0, 0.1, 0.2, 0.3], np.linspace(1.0, 0.5, w))
    found = pf.power_spectrum(frf, each)
    matrix = np.einsum("iw,ij->ijw", each, np.eye(6))
    names = dict(zip(frf.input.values.tolist(), each, strict=True))
    for other in (matrix, names):
        assert np.allclose(pf.power_spectrum(frf, other).psd, found.psd, rtol=1e-12, atol=0)
    assert np.allclose(np.sum(found.rms_by_input.values**2, axis=1), found.rms.values**2)


def test_inputs_that_are_one_signal_add_their_responses(frf):
    """Forces a x and b x of one white x: |a H_x + b H_y|², and the phase of the cross-spectrum counts."""
    mix = np.zeros(6, complex)
    mix[:2] = 1.0, -0.5j
    S = np.repeat(np.outer(mix, mix.conj())[..., None], frf.sizes["omega"], axis=2)
    expected = np.abs(np.einsum("oiw,i->ow", frf.values, mix)) ** 2
    found = pf.power_spectrum(frf, S)
    assert np.allclose(found.psd, expected, rtol=1e-9, atol=1e-12 * np.max(expected))
    assert "rms_by_input" not in found


def test_cross_spectra_as_scipy_estimates_them(hexapod):
    """Two forces that share a part, through the linear system in time: the output's spectrum by Welch's
    method against that of `csd(x_j, x_i)`, which differ by the leakage of 0.1 Hz alone."""
    model, state, forces, offset = hexapod
    label = "node[0]"
    lin = model.linearise(
        state, forces, inputs=(pf.NodeWrench(0, offset),), outputs=(pf.NodeMotion(0, offset),)
    )
    rng, rate, n = np.random.default_rng(1), 400.0, 2**15
    shared = rng.standard_normal(n)
    x = np.zeros((n, 6))
    x[:, 0], x[:, 1] = shared + 0.3 * rng.standard_normal(n), np.roll(shared, 2)
    t = np.arange(n) / rate
    y = lsim((lin.A, lin.B, lin.C, lin.D), x, t)[1][:, :2] @ (1.0, 0.7)  # along (1, 0.7)
    given = dict(fs=rate, nperseg=2**12)
    f, wanted = welch(y, **given)
    band = (f > 5) & (f < 60)
    S = np.array([[csd(x[:, j], x[:, i], **given)[1][band] for j in range(6)] for i in range(6)])
    S = S * np.sinc(f[band] / rate) ** 4  # straight between samples, as `lsim` takes the inputs
    H = lin.frf(2 * np.pi * f[band])
    mixed = H.isel(output=[0]).copy(data=(H.values[:1] + 0.7 * H.values[1:2]))
    found = pf.power_spectrum(mixed, S)
    assert label in str(H.output.values[0])
    power = np.trapezoid(wanted[band], f[band])
    assert float(found.rms[0]) ** 2 == pytest.approx(power, rel=3e-3)
    assert np.corrcoef(found.psd.values[0], wanted[band])[0, 1] > 0.99


def test_a_floor_that_shakes_at_random(hexapod):
    """The nonlinear model on 20 s of a floor of band-limited noise. The tool's RMS in the world is within
    three standard errors of that of the noise's density, ε² = 1 / (B T) with the bandwidth B = 2 π ζ f₀ of an
    oscillator (Bendat and Piersol, Random Data, ch. 8); and by Welch's spectrum of the very floor within its
    leakage, windows of 1 s at a bandwidth of 10 Hz."""
    model, state, _, offset = hexapod
    rate, seconds, f = 250.0, 20.0, np.arange(5.0, 50.0, 1 / 20)
    t, rng = np.arange(int(seconds * rate)) / rate, np.random.default_rng(5)
    level = 1e-12 * (10.0 / f) ** 2  # m²/Hz, as a line at each 1/T of variance level/T
    lines = np.sqrt(level / seconds) * (rng.standard_normal(len(f)) + 1j * rng.standard_normal(len(f)))
    s = np.minimum(1.0, t / 0.5)
    z = np.real(np.exp(2j * np.pi * np.outer(t, f)) @ lines) * s**3 * (10 - 15 * s + 6 * s**2)
    samples = pf.BaseSamples(t, np.outer(z, [0, 0, 1]))
    run = pf.simulate(model, np.zeros(6), state, t, base=samples, rtol=1e-4, atol=1e-11)
    moved, z = (run.dataset["position"].values[:, 2] - state.position[2])[t > 1], z[t > 1]
    omega = 2 * np.pi * np.linspace(f[0], f[-1], 8000)
    lin = model.linearise(state, np.zeros(6))
    floor = pf.transmissibility(lin, 0, offset)
    found = pf.power_spectrum(floor(omega), {"base_z": 1e-12 * (2 * np.pi * 10.0 / omega) ** 2})
    independent = ZETA * OMEGA_0 * seconds
    assert np.mean(moved**2) == pytest.approx(float(found.rms[2]) ** 2, rel=3 / np.sqrt(independent))
    g, shaken = welch(z, rate, nperseg=250)
    g, seen = welch(moved, rate, nperseg=250)
    band = (g > 3) & (g < 55)
    own = pf.power_spectrum(floor(2 * np.pi * g[band]), {"base_z": shaken[band]})
    assert np.trapezoid(seen[band], g[band]) == pytest.approx(float(own.rms[2]) ** 2, rel=0.03)


def test_a_grid_too_coarse_is_warned_of(hexapod):
    model, state, forces, offset = hexapod
    H = pf.compliance(model.linearise(state, forces), 0, offset)(np.linspace(1.0, 2000.0, 41))
    with pytest.warns(pf.ImplausibleValue, match="too few frequencies for its peaks"):
        pf.power_spectrum(H, {str(H.input.values[2]): 1.0})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda H: np.ones((5, 9)), r"psd has shape \(5, 9\); expected \(6, 20400\)"),
        (lambda H: -np.ones((6, 20400)), "psd of .*_fx is -1 at .* Hz; power spectra are not negative"),
        (lambda H: {"force": 1.0}, "psd names 'force', which is no input"),
        (lambda H: {str(H.input.values[0]): -1.0}, "is -1; a power spectral density is not negative"),
        (lambda H: {str(H.input.values[0]): [1.0, 2.0]}, "give a number, or one for each of 20400"),
        (lambda H: {}, "psd is empty"),
        (lambda H: np.triu(np.ones((6, 6)))[..., None] * np.ones(20400), "are not conjugate"),
        (lambda H: (1 - 2 * np.eye(6))[..., None] * np.ones(20400), "negative power"),
        (lambda H: np.full((6, 6, 20400), np.nan), "psd holds values that are not finite"),
    ],
)
def test_what_is_no_spectrum_is_said(frf, change, words):
    with pytest.raises(pf.InputError, match=words):
        pf.power_spectrum(frf, change(frf))
    with pytest.raises(pf.InputError, match="frf is no response"):
        pf.power_spectrum(np.ones(3), {})


@pytest.fixture(scope="module")
def floor(hexapod):
    """Transmissibility, and the response to the floor's acceleration, from 2 to 80 Hz."""
    model, state, forces, _ = hexapod
    omega = 2 * np.pi * np.geomspace(2.0, 80.0, 500)
    lin = model.linearise(state, forces, inputs=(pf.BaseAcceleration(),), outputs=(pf.NodeMotion(0),))
    return pf.transmissibility(lin, 0)(omega), lin.frf(omega)


def read(tmp_path, text, frf):
    path = tmp_path / "floor.csv"
    path.write_text(text, encoding="utf-8")
    return pf.load_psd(path, frf)


@pytest.mark.parametrize(
    ("unit", "order", "scale"),
    [
        ("um^2/Hz", 0, 1e-12),
        ("(mm/s)^2/Hz", 1, 1e-6),
        ("(m/s^2)^2/Hz", 2, 1.0),
        ("m^2/s^4/Hz", 2, 1.0),
        ("g^2/Hz", 2, 9.80665**2),
        ("g²/Hz", 2, 9.80665**2),
    ],
)
def test_files_in_units_of_the_trade(tmp_path, floor, unit, order, scale):
    """A density of a derivative is (2πf)² times that of what is derived; g² is that of the acceleration."""
    text = f"# a floor\nf [Hz]; base_z [{unit}]\n1; 2e-3\n100; 2e-3\n"
    for frf, own in zip(floor, (0, 2), strict=True):
        found = read(tmp_path, text, frf)
        f = frf.frequency.values
        expected = 2e-3 * scale * (2 * np.pi * f) ** (2 * (own - order))
        assert np.allclose(found.sel(input="base_z"), expected, rtol=1e-12, atol=0)
        assert not np.any(found.sel(input=["base_x", "base_rz"]))
    places, accelerations = (pf.power_spectrum(each, read(tmp_path, text, each)) for each in floor)
    assert np.all(places.rms.values[2] > 0)
    assert accelerations.rms.sizes["output"] == 6


def test_between_rows_spectra_are_straight_in_logarithms(tmp_path, floor):
    """A slope of −2 on both logarithmic scales, from corner points alone; beside zeros straight lines."""
    found = read(tmp_path, "f [Hz], base_z [m^2/Hz], base_x [m^2/Hz]\n1, 1, 0\n100, 1e-4, 99\n", floor[0])
    f = floor[0].frequency.values
    assert np.allclose(found.sel(input="base_z"), f**-2.0, rtol=1e-12)
    assert np.allclose(found.sel(input="base_x"), f - 1, rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "f [Hz], base_z\n1, 1\n100, 1\n",
            r"floor.csv:1: column base_z has no unit; write base_z \[m\^2/Hz\]",
        ),
        ("f [Hz], base_z [m^2]\n1, 1\n100, 1\n", "which is no square per Hz; write base_z"),
        ("f [Hz], base_z [m/sqrt(Hz)]\n1, 1\n100, 1\n", "is no square per Hz|is not the square of"),
        ("f [Hz], base_z [N^2/Hz]\n1, 1\n100, 1\n", "is not the square of a length or a speed or an accel"),
        ("f [Hz], base_z [m^2/(rad/s)]\n1, 1\n100, 1\n", "which is no square per Hz"),
        ("f, base_z [m^2/Hz]\n1, 1\n100, 1\n", "column f has no unit"),
        ("f [rad/s], base_z [m^2/Hz]\n1, 1\n100, 1\n", "the unit of column f"),
        ("base_z [m^2/Hz]\n1\n100\n", r"the first column is \"base_z\"; begin with f \[Hz\]"),
        ("f [Hz], floor_z [m^2/Hz]\n1, 1\n100, 1\n", 'column "floor_z" is not known'),
        ("f [Hz], base_z [m^2/Hz]\n1, 1\n100, -1\n", "base_z is negative at 100 Hz"),
        (
            "f [Hz], base_z [m^2/Hz]\n1, 1\n50, nan\n100, 1\n",
            "floor.csv:3: base_z is nan; leave such rows out",
        ),
        ("f [Hz], base_z [m^2/Hz]\n1, 1\n50,\n100, 1\n", "floor.csv:3: this row has 1 values"),
        ("f [Hz], base_z [m^2/Hz]\n1, 1\n100, 1\n50, 1\n", "floor.csv:4: f is 50, not later than 100"),
        ("f [Hz], base_z [m^2/Hz]\n0, 1\n100, 1\n", "one at f = 0"),
        ("f [Hz], base_z [m^2/Hz]\n3, 1\n100, 1\n", "goes from 3 to 100 Hz, and frf asks for 2 Hz"),
        ("f [Hz], base_z [m^2/Hz]\n1, 1\n70, 1\n", "goes from 1 to 70 Hz, and frf asks for 70"),
        ("", "floor.csv is empty; begin it with a header like f .Hz., base_x"),
        (
            "f [Hz], base_z [m^2/Hz]\n" + "".join(f"{k}, 1\n" for k in range(1, 101) if not 20 < k < 70),
            "has a gap from 20 to 70 Hz, where rows beside it are 1 Hz apart",
        ),
    ],
)
def test_files_that_hold_no_spectrum_are_refused(tmp_path, floor, text, words):
    with pytest.raises(pf.InputError, match=words):
        read(tmp_path, text, floor[0])


def test_even_and_logarithmic_rows_have_no_gap(tmp_path, floor):
    for f in (np.linspace(1, 100, 397), np.geomspace(1, 100, 30), np.geomspace(1, 100, 9) ** 1.0):
        rows = "".join(f"{each:.9g}, 1\n" for each in f)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert np.allclose(read(tmp_path, f"f [Hz], base_z [m^2/Hz]\n{rows}", floor[0])[2], 1.0)
    turning = read(tmp_path, "f [Hz], base_rz [mrad^2/Hz]\n1, 1\n100, 1\n", floor[0])
    assert np.allclose(turning.sel(input="base_rz"), 1e-6)


def test_labels_with_brackets_are_columns(tmp_path, hexapod):
    model, state, forces, _ = hexapod
    H = model.linearise(state, forces).frf(2 * np.pi * np.geomspace(2.0, 80.0, 500))
    found = read(tmp_path, "f [Hz], force[0] [N^2/Hz], force[3] [kN^2/Hz]\n1,1,2\n100,1,2\n", H)
    assert np.allclose(found[:, 0], [1, 0, 0, 2e6, 0, 0])
    assert np.all(pf.power_spectrum(H, found).rms > 0)
    with pytest.raises(pf.InputError, match=r"column force\[0\] has no unit"):
        read(tmp_path, "f [Hz], force[0]\n1,1\n100,1\n", H)
    with pytest.raises(pf.InputError, match="psd is of force.*, and frf has the inputs node"):
        pf.power_spectrum(pf.compliance(model.linearise(state, forces), 0)(H.omega.values), found)
