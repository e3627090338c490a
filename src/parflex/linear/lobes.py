"""Stability lobes: the depth of cut up to which a machine does not chatter, by spindle speed."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from parflex.base.array import Array
from parflex.base.check import finite, integer, positive
from parflex.base.errors import InputError


def stability_lobes(
    frf: Any, *, stiffness: float, teeth: int, direction: ArrayLike, speeds: ArrayLike
) -> Any:
    """The stability lobes of a cut, a Dataset.

    frf is the compliance of the tool (output, input, omega), as `pf.compliance(lin, node)(omega)` gives it,
    m/N, at frequencies dense enough for its peaks; stiffness K_s (N/m²) is the cutting force per depth and
    thickness of the chip, of all teeth in the cut together; direction is that of force and chip thickness: a
    vector (3,), or a pair (2, 3) of the force's and the thickness's, in the axes of the frf; speeds (s,) are
    in revolutions per minute. With G the compliance along them, the limits are b = −1 / (2 K_s Re G) at the
    speeds 60 f / (teeth (k + ε / 2π)), k = 0, 1, … and ε the lag of one tooth's wave to the next one's.

    limit (speed) m is the depth at each speed, `lowest` m the depth that is stable at any, chatter (speed) Hz
    the frequency at the limit; depth (omega) m and lobe_speed (lobe, omega) 1/min are the lobes themselves.

    Source: Tlusty, Manufacturing Processes and Equipment, ch. 9. Raises InputError for values that are not
    positive, a direction without length, and a compliance whose real part is nowhere negative in the band.
    """
    import xarray as xr

    K_s, teeth = positive("stiffness", stiffness), integer("teeth", teeth)
    if teeth < 1:
        raise InputError(f"teeth is {teeth}; a cutter has at least one")
    n = finite("speeds", speeds)
    if n.ndim != 1 or not n.size or np.any(n <= 0):
        raise InputError("speeds must be a list of positive speeds in revolutions per minute")
    G, f = along(frf, direction)
    gain = -2.0 * K_s * G.real  # 1 / depth of cut
    if not np.any(gain > 0):
        raise InputError(
            "frf: the real part of the compliance along the direction is nowhere negative, so that nothing "
            "limits the cut there; take a band that holds the resonances"
        )
    lag = 1.0 - np.arctan2(G.real, G.imag) / np.pi  # of one tooth's wave to the next one's, in turns
    lobes = np.arange(1 + int(np.ceil(60.0 * np.max(f) / (teeth * np.min(n)))))
    waves = lobes[:, None] + lag
    at = 60.0 * f / (teeth * np.where(waves > 0, waves, np.nan))
    limit, chatter = envelope(n, teeth, lag, gain, f)
    depth = np.where(gain > 0, 1.0 / np.where(gain > 0, gain, 1.0), np.nan)
    data = {
        "limit": (("speed",), limit, {"units": "m", "long_name": "depth of cut that is stable up to here"}),
        "chatter": (("speed",), chatter, {"units": "Hz", "long_name": "frequency at the limit"}),
        "lowest": ((), float(np.nanmin(depth)), {"units": "m", "long_name": "depth stable at any speed"}),
        "depth": (("omega",), depth, {"units": "m", "long_name": "depth of cut at the limit"}),
        "lobe_speed": (("lobe", "omega"), at, {"units": "1/min", "long_name": "spindle speed at the limit"}),
    }
    coords = {
        "speed": ("speed", n, {"units": "1/min", "long_name": "spindle speed"}),
        "lobe": lobes,
        "omega": ("omega", 2 * np.pi * f, {"units": "rad/s"}),
    }
    return xr.Dataset(data, coords)


def along(frf: Any, direction: ArrayLike) -> tuple[Array, Array]:
    """The compliance along a direction (w,), complex, and the frequencies (w,) Hz, the lowest first."""
    if getattr(frf, "dims", None) != ("output", "input", "omega") or min(frf.shape[:2]) < 3:
        raise InputError(
            "frf is no compliance (output, input, omega) of a tool; give pf.compliance(lin, node)(omega)"
        )
    given = finite("direction", direction)
    pair = np.stack([given, given]) if given.shape == (3,) else given
    if pair.shape != (2, 3) or not np.all(np.linalg.norm(pair, axis=1) > 0):
        raise InputError(
            "direction must be a vector (3,), or a pair (2, 3) of force and chip thickness, not zero"
        )
    force, thickness = pair / np.linalg.norm(pair, axis=1, keepdims=True)
    order = np.argsort(frf.omega.values)
    w = frf.omega.values[order]
    if len(w) < 2 or w[0] <= 0 or not np.all(np.diff(w) > 0):
        raise InputError("frf has fewer than two positive frequencies, or one twice; give a band")
    H = frf.values[:3, :3][..., order]
    return np.einsum("o,oiw,i->w", thickness, H, force), w / (2 * np.pi)


def envelope(speeds: Array, teeth: int, lag: Array, gain: Array, f: Array) -> tuple[Array, Array]:
    """The least depth (s,) of all lobes at each speed, infinite where none passes, and its frequency (s,) Hz.

    A lobe passes where a tooth's wave lags by whole turns: 60 f / (teeth n) − lag is a whole number.
    """
    found = np.array([largest(60.0 * f / (teeth * speed) - lag, gain, f) for speed in speeds])
    some = found[:, 0] > 0
    return np.where(some, 1.0 / np.where(some, found[:, 0], 1.0), np.inf), np.where(some, found[:, 1], np.nan)


def largest(turns: Array, gain: Array, f: Array) -> tuple[float, float]:
    """The largest gain where `turns` (w,) is whole, straight between neighbours, and its frequency."""
    step = np.diff(turns)
    whole = np.floor(np.maximum(turns[:-1], turns[1:]))
    i = np.flatnonzero((whole >= np.minimum(turns[:-1], turns[1:])) & (np.abs(step) < 0.5) & (step != 0))
    if not len(i):
        return 0.0, np.nan
    part = (whole[i] - turns[i]) / step[i]
    reached = gain[i] + part * (gain[i + 1] - gain[i])
    best = int(np.argmax(reached))
    return float(reached[best]), float(f[i[best]] + part[best] * (f[i[best] + 1] - f[i[best]]))
