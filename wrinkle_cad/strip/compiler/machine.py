"""From LLVM's language to machine code in this process."""

from __future__ import annotations

import ctypes
import threading
from functools import cache
from typing import Any, Final

import llvmlite.binding as llvm

_SPEED: Final = 3
_LOCK: Final = threading.RLock()


@cache
def _started() -> None:
    try:
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
    except RuntimeError:  # newer ones start by themselves
        pass


@cache
def host(processor: str | None) -> tuple[str, str]:
    """Name and features of this machine's processor, or of the one that is asked for."""
    _started()
    if processor is not None:
        return processor, ""
    return llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def version() -> str:
    """What compiles: machine code of another one is not taken."""
    return ".".join(map(str, llvm.llvm_version_info))


@cache
def _target(processor: str | None) -> Any:
    name, features = host(processor)
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(
        cpu=name, features=features, opt=_SPEED, reloc="pic", codemodel="small", jit=True
    )


@cache
def _engine(processor: str | None) -> Any:
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), _target(processor))


def object_code(text: str, processor: str | None) -> bytes:
    """Machine code of a module, as an object file."""
    with _LOCK:
        machine = _target(processor)
        module = llvm.parse_assembly(text)
        module.verify()
        options = llvm.create_pipeline_tuning_options(speed_level=_SPEED)
        options.loop_vectorization = True
        builder = llvm.create_pass_builder(machine, options)
        builder.getModulePassManager().run(module, builder)
        code: bytes = machine.emit_object(module)
        return code


def loaded(code: bytes, entry: str, processor: str | None) -> tuple[Any, Any]:
    """The two functions of an object file, to be called without the interpreter's lock."""
    with _LOCK:
        engine = _engine(processor)
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        pointer = ctypes.c_void_p
        run = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_char_p, pointer)
        free = ctypes.CFUNCTYPE(None, pointer)
        return (
            run(engine.get_function_address(entry)),
            free(engine.get_function_address(f"{entry}_free")),
        )
