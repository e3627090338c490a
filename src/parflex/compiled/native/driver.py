"""A motion's kernel as the right-hand side that an integrator in C calls: `rhs(dy, t, y, args, …)`.

`args` points at a block of machine words, which name the kernel and the arrays it runs on.
"""

from functools import cache
from typing import Any

import llvmlite.binding as llvm
import numpy as np

from parflex.base.array import Array
from parflex.compiled.native.native import engine, machine

WORDS = {  # of the block, in this order, with their LLVM types
    "run": "ptr",  # the kernel's code
    "pointers": "ptr",  # to its inputs and outputs; the first is the flat state
    "rates": "ptr",  # where among the pointers those to ẋ and, next to it, to the powers stand
    "time": "ptr",  # where the kernel reads the time
    "health": "ptr",  # where it leaves the health of the state
    "refused": "ptr",  # where to keep the last state that a leg does not reach
    "margins": "i64",  # numbers at the beginning of health that must not be too small
    "size": "i64",  # of the flat state
    "total": "i64",  # of y: the flat state and the works
}


def words_of(**words: int) -> Array:
    """The block of words; all must be given."""
    return np.array([words[name] for name in WORDS], dtype=np.uint64)


def unpacked() -> str:
    """LLVM text that reads each word of the block into a value of its name."""
    return "\n".join(
        f"  %word_{name} = getelementptr i64, ptr %block, i64 {i}\n  %{name} = load {kind}, ptr %word_{name}"
        for i, (name, kind) in enumerate(WORDS.items())
    )


# the kernel reads y and writes dy, in which the works follow the flat state; where a margin of health is too
# small, y is kept if it is a number, and dy is not one: the integrator then shortens its step
TEXT = """
define void @rhs(ptr %dy, double %t, ptr %y, ptr %args, ptr %unused) {
entry:
  %block = load ptr, ptr %args
UNPACKED
  store double %t, ptr %time
  store ptr %y, ptr %pointers
  %works = getelementptr double, ptr %dy, i64 %size
  %powers = getelementptr ptr, ptr %rates, i64 1
  store ptr %dy, ptr %rates
  store ptr %works, ptr %powers
  call void %run(ptr %pointers, i64 0, i64 1)
  br label %judge
judge:
  %margin = phi i64 [0, %entry], [%next_margin, %read]
  %judging = icmp slt i64 %margin, %margins
  br i1 %judging, label %read, label %done
read:
  %at_margin = getelementptr double, ptr %health, i64 %margin
  %value = load double, ptr %at_margin
  %next_margin = add i64 %margin, 1
  %good = fcmp ogt double %value, SMALLEST
  br i1 %good, label %judge, label %spoil
spoil:
  %entry_of_y = phi i64 [0, %read], [%next_entry, %spoil]
  %at_y = getelementptr double, ptr %y, i64 %entry_of_y
  %now = load double, ptr %at_y
  %at_refused = getelementptr double, ptr %refused, i64 %entry_of_y
  %before = load double, ptr %at_refused
  %is_number = fcmp ord double %now, %now
  %kept = select i1 %is_number, double %now, double %before
  store double %kept, ptr %at_refused
  %at_dy = getelementptr double, ptr %dy, i64 %entry_of_y
  store double 0x7FF8000000000000, ptr %at_dy
  %next_entry = add i64 %entry_of_y, 1
  %spoiling = icmp slt i64 %next_entry, %total
  br i1 %spoiling, label %spoil, label %done
done:
  ret void
}
"""


@cache
def right_hand_side(smallest: float) -> tuple[Any, int]:
    """The compiled function, whose margins must exceed the smallest: what keeps it alive, and its address."""
    text = TEXT.replace("UNPACKED", unpacked()).replace("SMALLEST", f"{smallest:e}")
    kept = engine(machine().emit_object(llvm.parse_assembly(text)))
    return kept, kept.get_function_address("rhs")
