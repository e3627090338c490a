"""Linear systems against published figures and closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from published_hexapods import compliance_point, cubic, dehaeze, hold

# identification.org and dynamics-study.org of the public stewart-simscape: Simscape, struts with their masses
FREQUENCIES = (780.6, 780.6, 903.9, 1061.4, 1061.4, 1269.6)
DAMPING = (0.25, 0.25, 0.28, 0.33, 0.33, 0.40)  # %; printed there in reverse order, see the test
COMPLIANCE = {(0, 0): 4.7e-8, (0, 4): 3.2e-7, (2, 2): 2.1e-8, (3, 3): 5.2e-6, (5, 5): 1.7e-6}


def half_a_digit(published):
    return 0.5 * 10.0 ** (np.floor(np.log10(published)) - 1)


def test_the_frequencies_of_a_published_hexapod():
    """Six frequencies of Simscape to its rounding; viscous struts damp by c ω / 2 k, so that the larger
    frequency has the larger ratio."""
    modes = hold(dehaeze()).modes()
    assert np.allclose(modes.frequency, FREQUENCIES, rtol=1e-4)
    assert np.allclose(100 * modes.damping, DAMPING, atol=0.005)
    assert np.allclose(modes.share.sel(part="drives"), 1.0, atol=1e-9)


def test_the_compliance_of_a_published_hexapod():
    lin = hold(dehaeze(), compliance_point(dehaeze()))
    wrench = [label for label in lin.inputs if label.startswith("node")]
    pose = [label for label in lin.outputs if label.startswith("node")]
    found = lin.frf([0.0]).sel(input=wrench, output=pose).values[..., 0].real
    for place, value in COMPLIANCE.items():
        assert abs(found[place] - value) <= half_a_digit(value) + 1e-3 * value
    assert found[0, 0] == pytest.approx(4.74996e-8, rel=1e-5)


K, L, M, INERTIA = 1e6, 0.4, 10.0, (0.1, 0.1, 0.2)
SQUARES = K * np.array([2, 2, 2, L**2 / 2, L**2 / 2, 2 * L**2]) / np.array([M, M, M, *INERTIA])


@pytest.mark.parametrize(("mass", "error"), [(1e-3, 2e-3), (1e-5, 2e-5), (1e-7, 1e-6)])
def test_a_cubic_hexapod(mass, error):
    """K = k diag(2, 2, 2, L²/2, L²/2, 2 L²) about the cube's centre (Preumont, Vibration Control of Active
    Structures); the error is the mass of the legs. Static compliance does not know it."""
    lin = hold(*cubic(mass, K, L, M, INERTIA))
    assert np.allclose(np.sort(lin.modes().frequency), np.sort(np.sqrt(SQUARES)) / (2 * np.pi), rtol=error)
    found = lin.frf([0.0]).values[:6, 6:, 0].real
    assert np.allclose(np.diag(found) * SQUARES * [M, M, M, *INERTIA], 1.0, rtol=1e-9)


@pytest.mark.parametrize("gain", [30.0, 300.0])
def test_integral_force_feedback_of_a_cubic_hexapod(gain):
    """Γ = −g ∫ τ dt on each strut has the poles s² + g s + Ω² (Preumont), closed by python-control."""
    control = pytest.importorskip("control")
    lin = hold(*cubic(1e-7, K, L, M, INERTIA))
    struts = [label for label in lin.outputs if label.startswith("strut")]
    motors = [label for label in lin.inputs if label.startswith("force")]
    plant = lin.to_control()[struts, motors]
    integrator = control.ss(np.zeros((6, 6)), np.eye(6), gain * np.eye(6), np.zeros((6, 6)))
    found = control.feedback(plant, integrator).poles()
    wanted = np.concatenate([np.roots([1.0, gain, square]) for square in SQUARES])
    assert max(np.min(np.abs(found - pole)) / abs(pole) for pole in wanted) <= 1e-5


def test_preload_softens_a_hexapod():
    """With gravity on soft struts the lowest frequency falls (test_linearise.py has the differences)."""
    robot, offset = cubic(1e-5, 2e4, L, M, INERTIA)
    heavy = replace(robot, gravity=(0.0, 0.0, -9.81))
    free, loaded = (hold(each, offset).modes().frequency.values for each in (robot, heavy))
    assert loaded[0] < 0.9999 * free[0]
