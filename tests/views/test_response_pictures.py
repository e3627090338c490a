"""Pictures of frequency responses, poles and lobes: curves are the data, in the units that are written."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import parflex as pf

K, M, ZETA = 1e6, 1.0, 0.03
OMEGA = 2 * np.pi * np.geomspace(10.0, 1000.0, 400)
OMEGA_0 = np.sqrt(K / M)


def response(outputs=2, inputs=2, omega=OMEGA, unit="m", per="N"):
    """Oscillators of frequencies that grow with output and input, m/N; others than the diagonal negative."""
    H = np.empty((outputs, inputs, len(omega)), complex)
    for o, i in np.ndindex(outputs, inputs):
        k = K * (1 + o + i)
        H[o, i] = (1 if o == i else -1) / (k - M * omega**2 + 2j * ZETA * np.sqrt(k * M) * omega)
    coords = {
        "output": [f"tool_{o}" for o in range(outputs)],
        "input": [f"force[{i}]" for i in range(inputs)],
    }
    coords |= {"omega": omega, "output_units": ("output", [unit] * outputs)}
    return xr.DataArray(H, coords | {"input_units": ("input", [per] * inputs)}, ("output", "input", "omega"))


def curves(ax):
    return [line.get_data() for line in ax.lines]


def words(fig: Figure):
    """All text of a figure."""
    return "\n".join(text.get_text() for text in fig.findobj(lambda each: hasattr(each, "get_text")))


def test_bode_of_one_entry():
    """Magnitude in m/N over hertz, phase from 0 to −180°: that of an oscillator."""
    H = response()
    fig = pf.plot.bode(H, outputs=["tool_0"], inputs=["force[0]"])
    upper, lower = fig.axes
    ((f, size),), ((_, phase),) = curves(upper), curves(lower)
    assert np.allclose(f, OMEGA / (2 * np.pi))
    assert np.allclose(size, np.abs(H.values[0, 0]))
    assert np.allclose(phase, -np.degrees(np.arctan2(2 * ZETA * OMEGA_0 * OMEGA, OMEGA_0**2 - OMEGA**2)))
    assert (upper.get_xscale(), upper.get_yscale(), lower.get_xscale()) == ("log", "log", "log")
    assert (upper.get_ylabel(), lower.get_ylabel()) == ("magnitude (m/N)", "phase (deg)")
    assert lower.get_xlabel() == "frequency (Hz)"
    chosen = pf.plot.bode(H.sel(output="tool_0", input="force[0]"))
    assert np.allclose(curves(chosen.axes[0])[0][1], size)


def test_bode_in_decibels_of_several_systems():
    """20 lg of the magnitude, re 1 m/N; a second system of a tenth is 20 dB below."""
    H = response(1, 1)
    fig = pf.plot.bode({"open": H, "closed": H.sortby("omega", ascending=False) / 10}, decibels=True)
    (_, open_), (_, closed) = curves(fig.axes[0])
    assert np.allclose(open_, 20 * np.log10(np.abs(H.values[0, 0])))
    assert np.allclose(open_ - closed, 20)
    assert fig.axes[0].get_ylabel() == "magnitude (dB re 1 m/N)"
    assert [text.get_text() for text in fig.legends[0].get_texts()] == ["open", "closed"]


def test_phases_are_unwrapped():
    """A delay of 10 ms turns by −360° · 0.01 s · f, at 50 Hz by −180°."""
    H = response(1, 1, 2 * np.pi * np.linspace(1.0, 500.0, 2000))
    H.values[0, 0] = np.exp(-0.01j * H.omega.values)
    ((f, phase),) = curves(pf.plot.bode(H).axes[1])
    assert np.allclose(phase, -3.6 * f)


def test_zero_frequency_has_no_place_on_a_logarithmic_axis():
    H = response(1, 1, np.concatenate([[0.0], OMEGA]))
    assert len(curves(pf.plot.bode(H).axes[0])[0][0]) == len(OMEGA)


def test_thirty_six_entries_are_a_grid():
    """Magnitudes alone; what symmetry makes zero is called none, and not drawn as noise."""
    H = response(6, 6)
    H.values[2, 3] = 1e-22
    for draw in (pf.plot.bode, pf.plot.nyquist):
        fig = draw(H)
        assert len(fig.axes) == 36
        assert not fig.axes[2 * 6 + 3].lines
        assert "none" in words(fig)
        assert "force[5] → 5" in words(fig)  # the labels' common beginning is told once
    assert "choose up to 3 outputs to see phases" in words(pf.plot.bode(H))
    assert len(pf.plot.bode(H, outputs=["tool_0", "tool_1"]).axes) == 2 * 2 * 6


def test_entries_that_are_zero_are_named_beside_few_curves():
    H = response()
    H.values[1, 0] = 1e-25
    fig = pf.plot.bode(H)
    assert len(fig.axes[0].lines) == 3
    assert "none: force[0] → 1" in words(fig)


def test_entries_of_unlike_units_do_not_share_axes():
    H = response()
    H = H.assign_coords(output_units=("output", ["m", "m/s^2"]))
    fig = pf.plot.bode(H)
    assert len(fig.axes) == 8
    assert "((m/s²)/N)" in words(fig)


def test_nyquist_is_to_scale():
    """The oscillator's circle, of about 1 / (2 ζ k) at its lowest: in 10⁻⁶ m/N here."""
    omega = 2 * np.pi * np.linspace(50.0, 300.0, 4001)
    fig = pf.plot.nyquist(response(1, 1, omega))
    (ax,) = fig.axes
    real, imaginary = next(data for data in curves(ax) if len(data[0]) == len(omega))
    assert np.min(imaginary) == pytest.approx(-1e6 / (2 * ZETA * K), rel=2e-3)
    assert ax.get_aspect() == 1.0
    assert ax.get_xlabel() == "real part (10⁻⁶ m/N)"
    assert "159 Hz" in words(fig)  # √(k/m (1 − 2ζ²)) = 159.01 Hz, on a grid of 1/16 Hz
    assert real[0] > 0


def test_a_gain_has_its_point_minus_one():
    fig = pf.plot.nyquist(response(1, 1, unit="N"))
    assert any(line.get_marker() == "+" for line in fig.axes[0].lines)
    assert "(10⁻⁶)" in fig.axes[0].get_xlabel()


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (lambda: pf.plot.bode(response(7, 6)), "7 outputs and 6 inputs, and a picture holds 36 .*outputs="),
        (lambda: pf.plot.bode(response(), outputs=["tool_9"]), "'tool_9', which there is not; did you mean"),
        (lambda: pf.plot.bode(response(), inputs=[]), "inputs is empty"),
        (lambda: pf.plot.bode(np.ones(3)), "frf is no response"),
        (
            lambda: pf.plot.bode({"a": response(), "b": response() * np.nan}),
            r"frf\['b'\] holds values that are",
        ),
        (lambda: pf.plot.nyquist(response(omega=OMEGA[:1])), "fewer than two frequencies"),
        (lambda: pf.plot.bode({}), "holds 0 systems"),
        (lambda: pf.plot.poles("a"), "lin is no linear system"),
        (lambda: pf.plot.poles(lin([-1.0]), band=(1, 2)), "where there are no poles"),
        (lambda: pf.plot.lobes({}), "holds 0 cuts"),
        (lambda: pf.plot.lobes(xr.Dataset()), "holds no stability lobes"),
    ],
)
def test_what_is_no_picture_is_said(draw, words):
    with pytest.raises(pf.InputError, match=words):
        draw()


def lin(poles):
    return SimpleNamespace(poles=np.array(poles, dtype=complex))


def test_poles_lie_on_their_rays():
    """A pair of 100 Hz and 5 %, twice, in hertz; and the ray of 5 %."""
    s = 2 * np.pi * 100 * (-0.05 + 1j * np.sqrt(1 - 0.05**2))
    fig = pf.plot.poles({"robot": lin([s, s.conjugate(), s, s.conjugate()]), "other": lin([-30.0])})
    (ax,) = fig.axes
    marks = [line for line in ax.lines if line.get_marker() == "x"]
    assert np.allclose(np.hypot(*marks[0].get_data()), 100)
    dashed = [
        line.get_data() for line in ax.lines if line.get_linestyle() == "--" and line.get_alpha() is None
    ]
    slopes = [abs(x[1] / y[1]) for x, y in dashed]
    assert min(abs(slope - 0.05 / np.sqrt(1 - 0.05**2)) for slope in slopes) < 1e-12
    assert "×2" in words(fig)
    assert "5 %" in words(fig)
    assert "1 outside 50 … 200 Hz" in words(pf.plot.poles(lin([s, -30.0]), band=(50, 200)))


def test_lobes_in_millimetres():
    omega = np.linspace(0.5, 3.0, 4001) * OMEGA_0
    given = dict(stiffness=2e9, teeth=2, direction=(1, 0, 0), speeds=np.linspace(500.0, 1e4, 100))
    found = pf.stability_lobes(tool(omega), **given)
    fig = pf.plot.lobes(found)
    upper, lower = fig.axes
    passes = np.isfinite(found.limit.values)
    assert np.allclose(curves(upper)[0][1][passes], 1e3 * found.limit.values[passes])
    assert np.allclose(curves(lower)[0][1], found.chatter.values, equal_nan=True)
    assert upper.get_ylabel() == "depth of cut (mm)"
    assert lower.get_xlabel() == "spindle speed (1/min)"
    assert f"{1e3 * float(found.lowest):.3g} mm at any speed" in words(fig)
    assert len(pf.plot.lobes({"a": found, "b": found}).axes[0].get_legend().get_texts()) == 2


def tool(omega):
    H = np.zeros((3, 3, len(omega)), complex)
    H[0, 0] = response(1, 1, omega).values[0, 0]
    return xr.DataArray(H, {"omega": omega}, ("output", "input", "omega"))


def test_random_vibration_in_its_units():
    """Density and cumulative RMS are those of the dataset, and unlike units stand side by side."""
    H = response().assign_coords(output_units=("output", ["m", "m/s^2"]))
    found = pf.power_spectrum(H, {"force[0]": 2.0})
    fig = pf.plot.power_spectrum(found)
    upper, lower = fig.axes[0], fig.axes[2]
    assert np.allclose(curves(upper)[0][1], found.psd.values[0])
    assert np.allclose(curves(lower)[0][1], found.cumulative_rms.values[0])
    labels = [ax.get_ylabel() for ax in fig.axes[:2]]
    assert labels == ["power spectral density (m²/Hz)", "power spectral density ((m/s²)²/Hz)"]
    assert f"RMS {float(found.rms[0]):.3g} m" in words(fig)
    assert len(pf.plot.power_spectrum({"a": found, "b": found}, outputs=["tool_0"]).axes) == 2
    five = pf.power_spectrum(response(5, 1), {"force[0]": 1.0})
    with pytest.raises(pf.InputError, match="5 outputs of 2 systems, and a picture 8 curves"):
        pf.plot.power_spectrum({"a": five, "b": five})
    with pytest.raises(pf.InputError, match="data holds no power spectra"):
        pf.plot.power_spectrum(xr.Dataset())
