"""Backend "native": kernels as machine code, by LLVM; no compiler is needed."""

import ctypes
import os
import threading
import warnings
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial

import llvmlite
import llvmlite.binding as llvm
import numpy as np

from parflex.base import cache as store
from parflex.base.array import Array
from parflex.base.progress import waiting
from parflex.compiled.backend import Backend, Function, Given, Trigger, in_order
from parflex.compiled.native.ir import module
from parflex.compiled.native.loops import program
from parflex.compiled.reference import NumpyFunction
from parflex.compiled.vm import VmFunction
from parflex.kernels.kernel import Kernel

AGREEMENT = 1e-9  # of code with the reference, on a probe
WIDE = 64  # rows from which on several share an instruction
REGION = 100  # loads and stores that LLVM orders at a time: what that takes grows with the square
SHARED = 64  # blocks of rows from which on processors share them

Run = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64)


class Code:
    """Machine code of a kernel, `lanes` rows at a time; keeps alive what it runs on."""

    def __init__(self, entry: store.Entry, lanes: int) -> None:
        self.lanes = lanes
        self._engine = engine(entry.code)
        self.address = self._engine.get_function_address("run")
        self.run = Run(self.address)
        self.sound = self._agrees(entry)

    def _agrees(self, entry: store.Entry) -> bool:
        """True where the code gives the same outputs as the reference gave when it was compiled."""
        found = [np.full(a.shape, np.nan) for a in entry.outputs]
        self.run(addresses([*entry.inputs, *found]).ctypes.data, 0, len(entry.inputs[0]) // self.lanes)
        scales = [np.nanmax(np.abs(a), initial=1.0) for a in entry.outputs]
        return all(
            np.allclose(a, b, rtol=0, atol=AGREEMENT * scale, equal_nan=True)
            for a, b, scale in zip(found, entry.outputs, scales, strict=True)
        )


class Call(partial[None]):
    """A call of machine code, and what must live as long: the code itself, and its arrays."""

    kept: tuple[object, ...]


class NativeFunction(Function):
    """A kernel as machine code; batches several rows per instruction, and on all processors."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel
        self._one = code(kernel, 1)
        self._wide: Code | None = None
        self._lock = threading.Lock()

    @property
    def address(self) -> int:
        """The address of `run(pointers, start, blocks)`, a block being one row."""
        found: int = self._one.address
        return found

    def _rows(self, rows: list[Array]) -> list[Array]:
        return self._run(self._for(len(rows[0])), rows)

    def _each(self, rows: list[Array]) -> list[Array]:
        return self._run(self._one, rows)

    def _run(self, code: Code, rows: list[Array]) -> list[Array]:
        count = len(rows[0])
        found = [np.empty((count, n)) for n in self.kernel.outputs.values()]
        run_rows(code, [*rows, *found], count)
        return found

    def bind(self, inputs: Given, outputs: Given) -> Trigger:
        given = in_order(self.kernel.inputs, inputs)
        taken = in_order(self.kernel.outputs, outputs, np.empty)
        places = addresses([*given, *taken])
        start, blocks = ctypes.c_int64(0), ctypes.c_int64(1)
        trigger = Call(self._one.run, ctypes.c_void_p(places.ctypes.data), start, blocks)
        trigger.kept = (self, places, given, taken)
        return trigger

    def _for(self, count: int) -> Code:
        """The code for so many rows, compiled at first use."""
        if count < WIDE:
            return self._one
        with self._lock:
            if self._wide is None:
                self._wide = code(self.kernel, widest())
            return self._wide


def run_rows(code: Code, arrays: list[Array], count: int) -> None:
    """All rows, shared by the processors; the last block overlaps where rows are left over."""
    places = addresses(arrays)
    blocks, shares = count // code.lanes, 1
    if blocks >= SHARED:
        shares = os.cpu_count() or 1
    ends = [blocks * i // shares for i in range(shares + 1)]

    def run(i: int) -> None:
        code.run(places.ctypes.data, ends[i] * code.lanes, ends[i + 1] - ends[i])

    if shares > 1:
        list(pool().map(run, range(shares)))
    else:
        run(0)
    if count % code.lanes:
        code.run(places.ctypes.data, count - code.lanes, 1)


def code(kernel: Kernel, lanes: int) -> Code:
    """Machine code from the cache, or compiled; raises Unsound where it is not what it should be."""
    key = code_key(kernel, lanes)
    entry = store.load(key)
    if entry is not None:
        found = Code(entry, lanes)
        if found.sound:
            return found
        warnings.warn("cached machine code does not give what it should; it is compiled anew", stacklevel=2)
    entry = compiled(kernel, lanes)
    found = Code(entry, lanes)
    if not found.sound:
        raise Unsound(f"machine code of the {kernel.name} model differs from the reference")
    store.save(key, entry)
    return found


def code_key(kernel: Kernel, lanes: int) -> str:
    """The name that a kernel's code for this processor has in the cache."""
    cpu, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    return store.key_of(kernel.name, kernel.subject, lanes, cpu, features, llvmlite.__version__)


class Unsound(Exception):
    """Machine code that does not give what the reference gives."""


def compiled(kernel: Kernel, lanes: int) -> store.Entry:
    """A kernel traced and compiled, with a probe and the reference's answer to it."""
    with waiting(f"compiling the {kernel.name} model"):
        text = module(program(kernel, widest() if lanes == 1 else 1), lanes, widest())
        object_code = machine().emit_object(llvm.parse_assembly(text))
    probe = kernel.probe(2 * lanes)
    answer = NumpyFunction(kernel)(**probe)
    return store.Entry(object_code, [probe[name] for name in kernel.inputs], list(answer.values()))


def engine(code: bytes) -> llvm.ExecutionEngine:
    """Object code, linked; it must outlive what is called in it."""
    found = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine())
    found.add_object_file(llvm.object_file.ObjectFileRef.from_data(code))
    found.finalize_object()
    return found


def machine() -> llvm.TargetMachine:
    """This processor; an engine takes possession of what it is given."""
    initialise()
    target = llvm.Target.from_default_triple()
    features = llvm.get_host_cpu_features().flatten()
    return target.create_target_machine(cpu=llvm.get_host_cpu_name(), features=features, opt=2)


@cache
def initialise() -> None:
    """Prepare LLVM for this processor, once.

    The option is one of the whole process: other users of llvmlite get code that is ordered by it, too.
    """
    llvm.set_option("parflex", f"-dag-maps-huge-region={REGION}")
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()


@cache
def widest() -> int:
    """Doubles in a vector register of this processor."""
    features = llvm.get_host_cpu_features()
    return 8 if features.get("avx512f") else 4 if features.get("avx") else 2


@cache
def pool() -> ThreadPoolExecutor:
    """Threads, as many as processors."""
    return ThreadPoolExecutor(os.cpu_count() or 1, thread_name_prefix="parflex")


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=pool.cache_clear)  # threads do not follow into a fork


def addresses(arrays: Sequence[Array]) -> Array:
    """The addresses at which the arrays begin; the arrays must outlive them."""
    return np.array([a.ctypes.data for a in arrays], dtype=np.uint64)


class NativeBackend(Backend):
    """Machine code by LLVM, kept in the user's cache."""

    name = "native"

    def compile(self, kernel: Kernel) -> Function:
        try:
            return NativeFunction(kernel)
        except (Unsound, RuntimeError, OSError) as error:  # a processor that LLVM does not serve
            warnings.warn(f"{error}; the virtual machine is used instead", stacklevel=2)
            return VmFunction(kernel)

    def keeps(self, kernel: Kernel) -> bool:
        return store.holds(code_key(kernel, 1))

    def version(self) -> str:
        version = ".".join(map(str, llvm.llvm_version_info))
        return f"LLVM {version} (llvmlite {llvmlite.__version__}), {widest()} states per instruction"
