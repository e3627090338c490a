"""Times on machines that are shared and noisy: contenders take turns, medians are kept."""

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

ROUNDS = 41
TURN = 2e-3  # s, at least, of one contender's turn: the clock and the loop are then of no account
LONG = 0.5  # s; what takes longer, even when it is cold, is called once a turn


class Time(NamedTuple):
    """Seconds per call: the median of the turns, and their quartiles."""

    median: float
    low: float
    high: float


def alternate(
    contenders: dict[str, Callable[[], object]],
    rounds: int = ROUNDS,
    clock: Callable[[], float] = time.perf_counter,
) -> dict[str, Time]:
    """Time of one call of each, the contenders taking turns; each is called at least once before.

    Where all of them run in the caller's thread alone, `time.thread_time` does not see what else the machine
    does.
    """
    repeats = {name: calls_per_turn(call) for name, call in contenders.items()}
    found: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(rounds):
        for name, call in contenders.items():
            found[name].append(turn(call, repeats[name], clock))
    return {name: summary(times) for name, times in found.items()}


def calls_per_turn(call: Callable[[], object]) -> int:
    """So many calls take `TURN`."""
    if turn(call, 1) >= LONG:
        return 1
    repeat = 1
    while turn(call, repeat) * repeat < TURN:
        repeat *= 2
    return repeat


def turn(call: Callable[[], object], repeat: int, clock: Callable[[], float] = time.perf_counter) -> float:
    """Seconds per call."""
    steps = range(repeat)
    start = clock()
    for _ in steps:
        call()
    return (clock() - start) / repeat


def summary(times: list[float]) -> Time:
    """Median and quartiles."""
    low, median, high = np.percentile(times, [25, 50, 75])
    return Time(float(median), float(low), float(high))
