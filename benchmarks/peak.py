"""What this processor can do at best: independent fused multiply–adds that wait for nothing, in registers."""

import ctypes
from functools import partial

import llvmlite.binding as llvm

from parflex.compiled.native.native import machine

CHAINS = 16  # more than latency times units, fewer than there are registers
STEPS = 20_000


class Peak:
    """A call `run` that makes `operations` additions and multiplications; a fused pair counts as two."""

    def __init__(self, lanes: int) -> None:
        self.lanes, self.operations = lanes, 2 * CHAINS * lanes * STEPS
        self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine())
        code = machine().emit_object(llvm.parse_assembly(loop(lanes)))
        self._engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(code))
        self._engine.finalize_object()
        function = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_int64)
        self.run = partial(function(self._engine.get_function_address("peak")), STEPS)


def loop(lanes: int) -> str:
    """IR of `double peak(steps)`: every chain is x ← x a + b."""
    kind = "double" if lanes == 1 else f"<{lanes} x double>"
    suffix = "f64" if lanes == 1 else f"v{lanes}f64"
    one = lambda x: x if lanes == 1 else "<" + ", ".join([f"double {x}"] * lanes) + ">"  # noqa: E731
    starts = [f"%x{i} = phi {kind} [{one(f'{i}.0')}, %entry], [%y{i}, %body]" for i in range(CHAINS)]
    steps = [
        f"%y{i} = call {kind} @llvm.fma.{suffix}({kind} %x{i}, {kind} {one('0.5')}, {kind} {one('1.0')})"
        for i in range(CHAINS)
    ]
    sums = [f"%s{i} = fadd {kind} %s{i - 1}, %y{i}" for i in range(2, CHAINS)]
    last = f"%s{CHAINS - 1}"
    found = f"%r = fadd double {last}, 0.0" if lanes == 1 else f"%r = extractelement {kind} {last}, i32 0"
    return "\n".join(
        [
            f"declare {kind} @llvm.fma.{suffix}({kind}, {kind}, {kind})",
            "define double @peak(i64 %steps) {",
            "entry:",
            "br label %body",
            "body:",
            "%n = phi i64 [0, %entry], [%next, %body]",
            *starts,
            *steps,
            "%next = add i64 %n, 1",
            "%more = icmp slt i64 %next, %steps",
            "br i1 %more, label %body, label %done",
            "done:",
            f"%s1 = fadd {kind} %y0, %y1",
            *sums,
            found,
            "ret double %r",
            "}",
        ]
    )
