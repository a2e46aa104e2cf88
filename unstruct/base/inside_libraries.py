"""The machine code of kernels, in memory and on the disk: a part of `inside_numba`."""

from __future__ import annotations

from typing import Any

try:
    from llvmlite import binding
    from numba.core.caching import CompileResultCacheImpl
    from numba.core.codegen import JITCodeLibrary
    from numba.core.compiler import compile_result
except (ImportError, AttributeError):  # another numba, or none
    CompileResultCacheImpl = JITCodeLibrary = object  # type: ignore[assignment, misc]

__all__ = ["CopiedCode", "CopiedLibrary", "KeptCode", "Library"]

LONG_WRAPPER = 120  # blocks


class Library(JITCodeLibrary):
    """The code of a kernel, of which numba also optimized the functions that are only declared."""

    def add_ir_module(self, ir_module: Any) -> None:
        """Add code; what takes Python's objects apart, once per call, is not optimized if it is long."""
        for function in ir_module.functions:
            if function.name.startswith("_ZN7cpython") and len(function.blocks) > LONG_WRAPPER:
                function.attributes.add("noinline")
                function.attributes.add("optnone")
        super().add_ir_module(ir_module)

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout
        for function in ll_module.functions:
            if not function.is_declaration:
                passes, options = self._codegen._function_pass_manager()
                passes.run(function, options)


class CopiedLibrary(Library):
    """The code of a kernel that is copied into its callers: no machine code is made of it."""

    @property
    def codegen(self) -> Any:
        return _NoMachineCode

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        self._ensure_finalized()
        return 0

    def _get_module_for_linking(self) -> Any:
        """The code itself, with functions that are dropped where they have been inlined."""
        self._ensure_finalized()
        if self._shared_module is None:
            self._shared_module = self._final_module
            for function in self._final_module.functions:
                if not function.is_declaration and function.linkage == binding.Linkage.external:
                    function.linkage = "linkonce_odr"
        return self._shared_module


class _NoMachineCode:
    """What numba asks for the place of machine code, to store there what kernels never use."""

    @staticmethod
    def set_env(name: str, env: Any) -> None:
        pass


class ReadLibrary(Library):
    """Machine code from the disk; its source is parsed only if a caller is compiled that copies it."""

    source = b""

    def _get_module_for_linking(self) -> Any:
        if self._shared_module is None:
            self._shared_module = binding.parse_bitcode(self.source)
        return self._shared_module


class KeptCode(CompileResultCacheImpl):
    """How a kernel is written to the disk, and read: as numba does it, without what kernels never use.

    numba would read its own modules for the environments of its functions, and parse all sources.
    """

    def reduce(self, result: Any) -> Any:
        """What is written."""
        result.fndesc.typemap = result.fndesc.calltypes = None
        name, _, (code, source) = result.library.serialize_using_object_code()
        module = result.library._get_module_for_linking()
        values = (*module.functions, *module.global_variables)
        symbols = tuple(value.name for value in values if not value.is_declaration)
        kept = (result.fndesc, result.environment, result.signature, result.reload_init)
        return name, code, source, symbols, kept

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        """The result of the compiler, from what was read."""
        name, code, source, symbols, (fndesc, environment, signature, references) = payload
        for refer in references:
            refer()
        library = ReadLibrary(target_context.codegen(), name)
        library.enable_object_caching()
        library._set_compiled_object(code)
        library.source = source
        library._finalize_final_module()
        library._codegen._engine._defined_symbols.update(symbols)
        return _result(target_context, library, fndesc, environment, signature, references)


class CopiedCode(CompileResultCacheImpl):
    """How a kernel that is copied into its callers is written to the disk, and read.

    Only callers that are compiled later need it; those on the disk have their copy.
    """

    def reduce(self, result: Any) -> Any:
        """What is written."""
        result.fndesc.typemap = result.fndesc.calltypes = None
        code = result.library._get_module_for_linking().as_bitcode()
        kept = (result.fndesc, result.environment, result.signature, result.reload_init)
        return result.library.name, code, kept

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        """The result of the compiler, from what was read."""
        name, code, (fndesc, environment, signature, references) = payload
        for refer in references:
            refer()
        library = CopiedLibrary(target_context.codegen(), name)
        library._final_module = binding.parse_bitcode(code)
        library._finalize_final_module()
        return _result(target_context, library, fndesc, environment, signature, references)


def _result(
    target_context: Any, library: Any, fndesc: Any, environment: Any, signature: Any, references: Any
) -> Any:
    return compile_result(
        typing_context=target_context.typing_context,
        target_context=target_context,
        entry_point=target_context.get_executable(library, fndesc, environment),
        signature=signature,
        objectmode=False,
        lifted=(),
        fndesc=fndesc,
        library=library,
        environment=environment,
        reload_init=references,
        referenced_envs=(),
    )
