"""LLVM code of our own: written with llvmlite, compiled for this processor, kept on disk, loaded by address.

Values are vectors of W lanes of float64. What is written here is what runs: no optimisation changes the order of
operations, and products are joined to sums only where `fma` says so. So each lane's numbers depend on neither its
neighbours nor W.
"""

import ctypes
import os
import sys
from collections.abc import Callable, Sequence
from functools import cache
from hashlib import sha256
from pathlib import Path
from tempfile import NamedTemporaryFile
from threading import Lock
from typing import Any

import llvmlite
import llvmlite.binding as llvm
from llvmlite import ir

from rainwind.dynamics.kernels.compiling import _root

DOUBLE, INT, POINTER = ir.DoubleType(), ir.IntType(64), ir.PointerType()
_BYTES = 8
_lock = Lock()
_engines: list[Any] = []  # own the code: kept for as long as the process lives


def widest_lanes() -> int:
    """How many lanes suit this processor: two of its vectors, at least four."""
    return 8 if llvm.get_host_cpu_features().get("avx512f") else 4


class Writer:
    """One function over W lanes, being written."""

    def __init__(self, name: str, lanes: int, pointers: Sequence[str]) -> None:
        self.module = ir.Module(name)
        self.module.triple = llvm.get_process_triple()
        self.lanes = lanes
        self.vector = ir.VectorType(DOUBLE, lanes)
        self.bits = ir.VectorType(INT, lanes)
        self.function = ir.Function(self.module, ir.FunctionType(INT, [POINTER] * len(pointers)), name)
        # vectors that registers have no room for then lie in one line of the cache each, not in two
        self.function.attributes.alignstack = 64
        for argument in self.function.args:
            argument.add_attribute("noalias")
        self.pointers = dict(zip(pointers, self.function.args, strict=True))
        self.b = ir.IRBuilder(self.function.append_basic_block("entry"))
        self._align = _BYTES * lanes

    # memory

    def load(self, pointer: Any, row: int) -> Any:
        """The vector `row` vectors after a pointer."""
        return self.b.load(self._at(pointer, row), align=self._align, typ=self.vector)

    def store(self, value: Any, pointer: Any, row: int) -> None:
        """Store a vector `row` vectors after a pointer."""
        self.b.store(value, self._at(pointer, row), align=self._align)

    def ahead(self, pointer: Any, count: Any) -> Any:
        """A pointer `count` vectors (a value) after another."""
        offset = self.b.mul(count, INT(self._align))
        return self.b.gep(pointer, [offset], source_etype=ir.IntType(8))

    def _at(self, pointer: Any, row: int) -> Any:
        return self.b.gep(pointer, [INT(row * self._align)], source_etype=ir.IntType(8)) if row else pointer

    # arithmetic

    def number(self, value: float) -> Any:
        """A constant in all lanes."""
        return ir.Constant(self.vector, [value] * self.lanes)

    def whole(self, value: int) -> Any:
        """A whole constant in all lanes."""
        return ir.Constant(self.bits, [value] * self.lanes)

    def fma(self, a: Any, b: Any, c: Any) -> Any:
        """a b + c, rounded once."""
        return self._intrinsic("llvm.fma", a, b, c)

    def absolute(self, a: Any) -> Any:
        """|a|."""
        return self._intrinsic("llvm.fabs", a)

    def root(self, a: Any) -> Any:
        """The square root, correctly rounded."""
        return self._intrinsic("llvm.sqrt", a)

    def nearest(self, a: Any) -> Any:
        """Rounded to whole numbers, halves to even."""
        return self._intrinsic("llvm.rint", a)

    def larger(self, a: Any, b: Any) -> Any:
        """The larger of two; b where a is not a number."""
        return self.b.select(self.b.fcmp_ordered(">", a, b), a, b)

    def smaller(self, a: Any, b: Any) -> Any:
        """The smaller of two; b where a is not a number."""
        return self.b.select(self.b.fcmp_ordered("<", a, b), a, b)

    def splat(self, scalar: Any) -> Any:
        """A scalar value in all lanes."""
        one = self.b.insert_element(ir.Constant(self.vector, ir.Undefined), scalar, INT(0))
        zeros = ir.Constant(ir.VectorType(ir.IntType(32), self.lanes), [0] * self.lanes)
        return self.b.shuffle_vector(one, ir.Constant(self.vector, ir.Undefined), zeros)

    def mask(self, condition: Any) -> Any:
        """A condition of all lanes as a whole number, one bit a lane."""
        return self.b.zext(self.b.bitcast(condition, ir.IntType(self.lanes)), INT)

    def each(self, name: str, *arguments: Any) -> Any:
        """A function of the C library, lane by lane."""
        kind = ir.FunctionType(DOUBLE, [DOUBLE] * len(arguments))
        function = self._declared(_PREFIX + name, kind)
        found = ir.Constant(self.vector, ir.Undefined)
        for lane in range(self.lanes):
            at = INT(lane)
            value = self.b.call(function, [self.b.extract_element(a, at) for a in arguments])
            found = self.b.insert_element(found, value, at)
        return found

    def _intrinsic(self, name: str, *arguments: Any) -> Any:
        kind = ir.FunctionType(self.vector, [self.vector] * len(arguments))
        return self.b.call(self._declared(f"{name}.v{self.lanes}f64", kind), arguments)

    def _declared(self, name: str, kind: Any) -> Any:
        found = self.module.globals.get(name)
        return ir.Function(self.module, kind, name) if found is None else found


def address(key: str, write: Callable[[], Writer]) -> int:
    """Where a function's code lies, compiled now or by an earlier process.

    key: all that the code depends on; `write` is called only where no code is kept for it.
    """
    digest = sha256("\n".join((key, *_machine(), _sources())).encode()).hexdigest()[:32]
    with _lock:
        if digest not in _addresses:
            path = _root() / "taylor" / f"{digest}.o"
            code = _kept(path)
            if code is None:
                code = _compile(write())
                _keep(path, code)
            _addresses[digest] = _load(code, key.split("\n")[0])
        return _addresses[digest]


_addresses: dict[str, int] = {}
_PREFIX = "rainwind_libm_"
_FUNCTIONS = (
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "exp",
    "log",
    "erf",
    "pow",
)


@cache
def _machine() -> tuple[str, ...]:
    features = llvm.get_host_cpu_features()
    return llvm.get_process_triple(), llvm.get_host_cpu_name(), _features(features), llvmlite.__version__


def _features(found: Any) -> str:
    features = found.flatten()
    # else LLVM cuts vectors of eight into halves on processors that once ran slower with them
    return features + ",-prefer-256-bit" if found.get("avx512f") else features


@cache
def _sources() -> str:
    here = Path(__file__).parent
    names = ("machine_code", "vector_math", "taylor_code")
    return sha256(b"".join((here / f"{name}.py").read_bytes() for name in names)).hexdigest()


@cache
def _target_machine() -> Any:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    triple, cpu, features, _ = _machine()
    static = triple.startswith(("x86", "i386", "i686"))
    return llvm.Target.from_triple(triple).create_target_machine(
        cpu=cpu,
        features=features,
        opt=2,
        reloc="static" if static else "default",
        codemodel="jitdefault",
        jit=True,
    )


def _compile(writer: Writer) -> bytes:
    module = llvm.parse_assembly(str(writer.module))
    module.verify()
    return _target_machine().emit_object(module)


def _load(code: bytes, name: str) -> int:
    _offer_libm()
    module = llvm.parse_assembly(f'target triple = "{llvm.get_process_triple()}"')
    engine = llvm.create_mcjit_compiler(module, _target_machine())
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)
    return engine.get_function_address(name)


@cache
def _offer_libm() -> None:
    """Make the C library's functions known under names of our own."""
    library = ctypes.CDLL("ucrtbase" if sys.platform == "win32" else None)
    for name in _FUNCTIONS:
        pointer = ctypes.cast(getattr(library, name), ctypes.c_void_p).value
        llvm.add_symbol(_PREFIX + name, pointer)


def _kept(path: Path) -> bytes | None:
    try:
        return path.read_bytes()
    except OSError:
        return None


def _keep(path: Path, code: bytes) -> None:
    """Write code for later processes; where that is not possible, they compile it again."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with NamedTemporaryFile(dir=path.parent, delete=False) as file:
            file.write(code)
        os.replace(file.name, path)
    except OSError:
        pass
