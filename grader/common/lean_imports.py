"""Leave out of an import what nobody here uses: servers, and what they are made of.

`import nbgrader` imports four extensions of Jupyter's server, and with them nbconvert, tornado's
handlers and a client of HTTP: a third of a second of processor time. A command that only reads
the gradebook uses none of it.
"""

import gc
import importlib.util
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

UNUSED = ('nbgrader', 'nbgrader.utils', 'requests')
"""What nbgrader's database imports, and asks for nothing: `utils` brings setuptools."""
FORMATS = ('isoduration', 'rfc3986_validator', 'rfc3987', 'rfc3987_syntax')
"""What jsonschema checks durations and addresses with, where it has it and a schema names them:
ours do not, nor do nbformat's."""


class _Unmade(ModuleType):
    """A module whose code has not run: the first of its names that is asked for runs it.

    Where importlib's LazyLoader is used, the next import of it, or of a module in it, does.
    """

    def __getattr__(self, name: str) -> Any:
        in_it = '__path__' in vars(self) and importlib.util.find_spec(f'{self.__name__}.{name}')
        if in_it or name == '__path__':
            raise AttributeError(name)  # Python imports a module then
        spec = self.__spec__
        assert spec  # as it was found
        assert spec.loader
        self.__class__ = ModuleType  # type: ignore[assignment]
        spec.loader.exec_module(self)
        return getattr(self, name)


@contextmanager
def uncollected() -> Iterator[None]:
    """Keep Python from looking for garbage in what is imported meanwhile, and from then on."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def leave_out_servers() -> None:
    """Put off what is UNUSED, as far as this process has not imported it."""
    for name in UNUSED:
        spec = None if name in sys.modules else importlib.util.find_spec(name)
        if spec is None:
            continue
        module = _Unmade(name)
        module.__spec__, module.__loader__, module.__file__ = spec, spec.loader, spec.origin
        module.__package__ = spec.parent
        if spec.submodule_search_locations is not None:
            module.__path__ = spec.submodule_search_locations
        sys.modules[name] = module


def leave_out_formats() -> None:
    """Import jsonschema as if FORMATS were not installed: they take as long as all the rest."""
    absent = [name for name in FORMATS if name not in sys.modules]
    sys.modules.update(dict.fromkeys(absent))  # type: ignore[arg-type]  # so Python marks them
    try:
        importlib.import_module('jsonschema')
    finally:
        for name in absent:
            del sys.modules[name]
