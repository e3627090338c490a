"""parflex itself: machine code, virtual machine and NumPy, flat and comfortable."""

import numpy as np

import parflex as pf
from benchmarks.rivals.base import Rival, Task
from sample import Sample

BACKENDS = ("native", "vm", "numpy")


class Parflex(Rival):
    """`flat` is `model.compiled()`, for loops; `call` is the comfortable `model.direct`."""

    name = "parflex"

    def __init__(self, sample: Sample, backends: tuple[str, ...] = BACKENDS) -> None:
        super().__init__(sample)
        self.models = {backend: pf.Model(sample.robot, backend) for backend in backends}

    def direct(self, s: int) -> dict[str, Task]:
        return self._ways("direct", s, self.sample.forces[s], 6)

    def inverse(self, s: int) -> dict[str, Task]:
        return self._ways("inverse", s, self.sample.target[s], self.sample.robot.n_forces)

    def _ways(self, question: str, s: int, given: np.ndarray, first: int) -> dict[str, Task]:
        ways = {}
        for backend, model in self.models.items():
            if backend != "numpy":
                ways[f"{backend}, flat"] = flat(model, question, self.sample.platform[s], given, first)
            ways[f"{backend}, call"] = comfortable(model, question, self.sample.platform[s], given)
        return ways


def flat(model: pf.Model, question: str, state: pf.State, given: np.ndarray, first: int) -> Task:
    """On flat arrays; the inverse model's q̈_e is not part of the answer."""
    compiled, modes = model.compiled(), model.robot.platform.modes
    run, x, out = getattr(compiled, question), compiled.pack(state), np.zeros(first + modes)
    given = np.ascontiguousarray(given)
    taken = out if question == "direct" else out[:first]
    return Task(lambda: run(x, given, out), taken.copy)


def comfortable(model: pf.Model, question: str, state: pf.State, given: np.ndarray) -> Task:
    """With its checks and named results."""
    run, kept = getattr(model, question), []

    def call() -> None:
        kept[:] = [run(state, given)]

    def answer() -> np.ndarray:
        found = kept[0]
        return found.forces if question == "inverse" else np.concatenate([found.platform, found.elastic])

    return Task(call, answer)
