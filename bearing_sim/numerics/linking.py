# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compiled functions that are optimised once: in the function that Python calls.

Numba optimises every function that a compiled function calls, turns it into machine code and keeps that on the disk, as a library of its own, and
does it once more in each library that calls it.  A step of level ``spatial`` has 170 of these, nested fifteen deep: nine tenths of the time to
compile it went into code that nobody executes.  Here a function that compiled code calls is only translated to the compiler's language; a function
that Python calls links all that it calls, directly or not, and is optimised as a whole.  It alone has machine code, a wrapper and a file on the disk.
Its named tuples are passed on by reference (`bearing_sim.numerics.reference`).

The file has a digest of its contents: machine code with one wrong bit may end the process.  Its name tells the function, the types of its arguments
and the processor; paths do not matter, so that all installations of the same code share it.

This uses interfaces of numba that it does not promise to keep: ``test/test_linking.py`` names them, and fails where they have changed.
"""

import gc
import hashlib
import pickle
import sys
from collections.abc import Callable
from contextlib import contextmanager
from inspect import signature
from pathlib import Path

from llvmlite.binding import Linkage
from numba.core import compiler, serialize, sigutils, types, typing
from numba.core.caching import NullCache
from numba.core.codegen import CPUCodeLibrary, JITCodeLibrary
from numba.core.compiler import CompileResult, Flags
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import _FunctionCompiler
from numba.core.environment import lookup_environment
from numba.core.registry import CPUDispatcher

from bearing_sim.files.kept import kept_if_possible, read_kept, with_digest, without_digest, write_kept
from bearing_sim.files.limits import COMPILED_FILE
from bearing_sim.numerics.reference import refer


class _Translation(CPUCodeLibrary):
    """The code of a function that compiled code calls, neither optimised as a whole nor turned into machine code."""

    def finalize(self):
        self._raise_if_finalized()
        self._finalize_dynamic_globals()
        self._finalized = True

    def alone(self):
        """Return its code without that of what it calls."""
        return super()._get_module_for_linking()

    def _get_module_for_linking(self):
        """Return its code with that of what it calls: a function that numba itself compiles links nothing else."""
        whole = self.alone().clone()
        for library in _callers_first(self._linking_libraries):
            whole.link_in(_code_alone(library), preserve=True)
        return whole


class _Program(JITCodeLibrary):
    """The code of a function that Python calls, with that of all functions that it calls, directly or not."""

    def finalize(self):
        for library in _callers_first(self._linking_libraries):
            self._final_module.link_in(_code_alone(library), preserve=True)
        self._linking_libraries = []
        super().finalize()

    def _optimize_final_module(self):
        # Nobody else calls these: the optimiser may take in a function that is called once, and leave it out elsewhere.
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage == Linkage.linkonce_odr:
                function.linkage = "internal"
        super()._optimize_final_module()


def _callers_first(libraries) -> list:
    """Return libraries and all that they call, each before what it calls itself: the linker takes only functions that it has seen called."""
    found: dict = {}
    for library in libraries:
        _add_callees_first(library, found)
    return [*reversed(found)]


def _add_callees_first(library, found: dict) -> None:
    if library not in found:
        for callee in library._linking_libraries if isinstance(library, _Translation) else ():
            _add_callees_first(callee, found)
        found[library] = None


def _code_alone(library):
    return library.alone() if isinstance(library, _Translation) else library._get_module_for_linking()


@contextmanager
def _without_garbage_collection():
    """Leave garbage for later: the compiler keeps hundreds of thousands of objects, and Python would search all of them again and again."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


class _Compiler(_FunctionCompiler):
    """Compiles a function to be called from Python, as numba does, or translates it to be called from compiled code."""

    dispatcher: "LinkingDispatcher"

    def _compile_core(self, args, return_type):
        with _without_garbage_collection():
            return self._compile_program(args, return_type)

    def _compile_program(self, args, return_type):
        function = _with_references(self.dispatcher) if any(isinstance(each, types.BaseNamedTuple) for each in args) else self.py_func
        library = _Program(self.targetdescr.target_context.codegen(), self.py_func.__qualname__)
        library.enable_object_caching()
        found = self._compile(function, args, return_type, library, self._flags())
        for name in (variable.name for variable in library._final_module.global_variables):
            if name.startswith("_ZN08NumbaEnv") and (environment := lookup_environment(name)) is not None:
                library.codegen.set_env(name, environment)
        return found

    def translate(self, args) -> CompileResult:
        """Return the function for such arguments, as compiled code calls it."""
        flags = self._flags()
        flags.no_cpython_wrapper = flags.no_compile = True
        return self._compile(self.py_func, args, None, _Translation(self.targetdescr.target_context.codegen(), self.py_func.__qualname__), flags)

    def _flags(self) -> Flags:
        flags = Flags()
        self.targetdescr.options.parse_as_flags(flags, self.targetoptions)
        return flags

    def _compile(self, function, args, return_type, library, flags) -> CompileResult:
        contexts = self.targetdescr.typing_context, self.targetdescr.target_context
        return compiler.compile_extra(*contexts, function, args, return_type, flags, self.locals, library, self.pipeline_class)


class LinkingDispatcher(CPUDispatcher):
    """A compiled function: numba's, with the versions that Python calls, and beside them those that compiled code calls.

    Parameters
    ----------
    function : to be compiled.
    folder : of the files with machine code.
    options : of numba's compiler.
    """

    def __init__(self, function: Callable, folder: Path, options: dict):
        super().__init__(function, targetoptions=options)
        self._compiler = _Compiler(function, self.targetdescr, options, self.locals, compiler.Compiler)
        self._compiler.dispatcher = self
        self._cache = _Files(self, folder)
        self._translated: dict[tuple, CompileResult] = {}

    def get_call_template(self, args, kws):
        """Return how compiled code calls the function with arguments of such types."""
        parameters, args = self._compiler.fold_argument_types(args, kws)
        name = self.py_func.__name__
        template = typing.make_concrete_template(f"CallTemplate({name})", key=name, signatures=[self._translation(tuple(args)).signature])
        return template, parameters, args, {}

    def get_overload(self, sig):
        """Return what stands for the version of a signature in compiled code."""
        return self._translation(tuple(sigutils.normalize_signature(sig)[0])).entry_point

    def _translation(self, args: tuple) -> CompileResult:
        if args not in self._translated:
            with global_compiler_lock:
                found = self._compiler.translate(args)._replace(entry_point=object())  # which only stands for it
                self.targetctx.insert_user_function(found.entry_point, found.fndesc, [found.library])
                self._translated[args] = found
        return self._translated[args]

    @property
    def is_compiling(self) -> bool:
        """False: numba asks it of recursive functions, which there are none of."""
        return False

    def is_kept(self, complete: bool = False) -> bool:
        """Return whether the disk holds a version of the function, of arguments with (False) or without (True) a None among their parts."""
        return any(self._cache.folder.glob(f"{self._cache.name}-{'' if complete else 'none-'}{'[0-9a-f]' * 16}.code"))


def _with_references(dispatcher: LinkingDispatcher) -> Callable:
    """Return the function that Python calls: it calls that of a dispatcher with references instead of named tuples."""
    function = dispatcher.py_func
    names = list(signature(function).parameters)
    passed = ", ".join(f"_refer({name})" for name in names)
    text = f"def {function.__name__}({', '.join(names)}):\n    return _function({passed})\n"
    found = {"_function": dispatcher, "_refer": refer, "__name__": function.__module__}
    exec(compile(text, function.__code__.co_filename, "exec"), found)
    return found[function.__name__]


class _Files(NullCache):
    """The machine code of a function on the disk, a file for each version that Python calls; none of a function with variables of another one."""

    def __init__(self, dispatcher: LinkingDispatcher, folder: Path):
        self._function, self.folder = dispatcher.py_func, folder
        self.name = f"{self._function.__module__}.{self._function.__qualname__}"

    def _path(self, sig, codegen) -> Path:
        code = self._function.__code__
        source = Path(code.co_filename).read_bytes()  # it need not be among those that the folder is named by, as in a test
        version = sigutils.normalize_signature(sig)[0], codegen.magic_tuple(), sys.implementation.cache_tag, code.co_firstlineno
        incomplete = "none-" if any("none" in str(each) for each in version[0]) else ""
        return self.folder / f"{self.name}-{incomplete}{hashlib.sha256(source + repr(version).encode()).hexdigest()[:16]}.code"

    def load_overload(self, sig, target_context):
        """Return the version that is kept; None where there is none, or a damaged one."""
        target_context.refresh()
        if self._function.__closure__:
            return None
        return read_kept(self._path(sig, target_context.codegen()), COMPILED_FILE, lambda stored: _loaded(stored, target_context))

    def save_overload(self, sig, data):
        """Keep a version if the folder can be written."""
        if self._function.__closure__ or data.library.has_dynamic_globals:
            return
        path = self._path(sig, data.codegen)
        with kept_if_possible(path):
            write_kept(path, _stored(data))


def _stored(found: CompileResult) -> bytes:
    library, module = found.library, found.library._final_module
    defined = [each.name for each in (*module.functions, *module.global_variables) if not each.is_declaration]
    found.fndesc.typemap = found.fndesc.calltypes = None
    environments = tuple(found._find_referenced_environments())
    parts = (library.name, library._get_compiled_object(), defined, found.fndesc, found.environment, found.signature, environments)
    return with_digest(serialize.dumps(parts))


def _loaded(stored: bytes, context) -> CompileResult:
    name, code, defined, description, environment, found_signature, environments = pickle.loads(without_digest(stored))
    library = _Program(context.codegen(), name)
    library.enable_object_caching()
    library._set_compiled_object(code)
    library._finalize_final_module()
    library.codegen._engine._defined_symbols.update(defined)
    found = CompileResult(
        typing_context=context.typing_context,
        target_context=context,
        entry_point=context.get_executable(library, description, environment),
        typing_error=None,
        type_annotation=None,
        signature=found_signature,
        objectmode=False,
        lifted=(),
        fndesc=description,
        library=library,
        call_helper=None,
        environment=environment,
        metadata=None,
        reload_init=(),
        referenced_envs=environments,
    )
    for each in environments:
        library.codegen.set_env(each.env_name, each)
    return found
