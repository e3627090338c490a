"""parflex with legs that bend."""

import numpy as np

from benchmarks.rivals.base import Task, in_platform_axes
from benchmarks.rivals.parflex import Parflex
from parflex.kernels.motion import derivative
from parflex.model.core import core_of


class ParflexLegs(Parflex):
    """The direct model, which leaves out the accelerations of the legs, and the rate of the state, which has
    them."""

    def direct(self, s: int) -> dict[str, Task]:
        return {"native, flat, legs too": self.rate(s)} | super().direct(s)

    def rate(self, s: int) -> Task:
        """ẋ of the flat state."""
        model, state = self.models["native"], self.sample.platform[s]
        core, x = core_of(model), model.compiled().pack(state)
        at, load, out = core.mechanism.layout.at, np.zeros(6 + self.sample.body.modes), np.zeros(len(x))
        given = {"x": x, "forces": np.ascontiguousarray(self.sample.forces[s]), "load": load}
        call = core.functions(derivative).bind(given, {"rate": out})

        def answer() -> np.ndarray:
            platform = in_platform_axes(out[at.twist], np.asarray(state.twist))
            return np.concatenate([platform, out[at.elastic_rate], out[at.joint_rates]])

        return Task(call, answer)
