"""A look at the gains of an output during a motion."""

import warnings

import numpy as np

from parflex.analysis.gains import beyond_words, check_gain, ratio
from parflex.base.array import Array, transpose
from parflex.base.errors import DynamicSingularity
from parflex.compiled.functions import Functions
from parflex.kernels import models
from parflex.kernels.parametrised import Build
from parflex.mechanics.output import Output


class Watch:
    """A look at the gains of an output during a motion.

    The determinants of ∂output/∂Γ, as the kernel `gains` gives it and for a rigid robot, keep the signs they
    started with until a singularity is crossed.
    """

    def __init__(self, functions: Functions, output: Output, gains: Build = models.gains) -> None:
        self._mechanism, self._output = functions.mechanism, output
        self._function = functions(gains, output)
        self._start: Array | None = None
        self._last = np.zeros(0)  # gains, flexible and rigid, (2, o, m)

    def look(self, x: Array) -> tuple[int, str]:
        """The number of flat states (T, size) of a motion before it crosses a singularity, and which it is.

        Crossing is seen from the first look; the words are empty where there is none.
        """
        shape = (2, len(x), self._output.size, self._mechanism.n_forces)
        gains = np.array(list(self._function.each(x=x).values())).reshape(shape)
        if self._start is None:
            self._start = gains[:, 0]
            if check_gain(self._mechanism, self._output, x[0], *(gain.reshape(-1) for gain in self._start)):
                warnings.warn(beyond_words(np.array(True)), DynamicSingularity, stacklevel=5)  # of simulate
        with np.errstate(over="ignore", invalid="ignore"):  # of a motion that diverges
            flexible, rigid = np.linalg.det(gains @ transpose(self._start)[:, None])
        crossed = (flexible < 0) | (rigid < 0)
        before = int(np.argmax(crossed)) if np.any(crossed) else len(x)
        self._last = gains[:, max(before, 1) - 1]
        if before == len(x):
            return before, ""
        if rigid[before] < 0:
            return before, "the motion has crossed a parallel singularity: det J_p⁻¹ changed sign"
        words = "the motion has crossed a dynamic singularity: the determinant of ∂V̇_p/∂Γ changed sign"
        return before, words

    def explain(self) -> str:
        """The sentence about a singularity that the motion has run into without crossing it; empty for
        none."""
        if self._start is None:
            return ""
        scale = self._output.lengths(self._mechanism)[:, None]
        (flexible, rigid), (flexible_0, rigid_0) = scale * self._last, scale * self._start
        now, start, kind = ratio(rigid), ratio(rigid_0), "parallel"
        if now > 0.05 * start:
            now, start, kind = ratio(flexible), ratio(flexible_0), "dynamic"
        if now > 0.05 * start:
            return ""
        return (
            f"a {kind} singularity is near: the weakest gain from forces to acceleration has fallen "
            f"to {now / start:.1e} of its value at the start"
        )
