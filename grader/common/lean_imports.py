"""Avoid imports that are not used here: servers, and the libraries that they need.

`import nbgrader` imports four extensions of Jupyter's server, and with them nbconvert, tornado's
handlers and an HTTP client: a third of a second of CPU time. A command that only reads the
gradebook uses none of them.
"""

import gc
import importlib.util
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

UNUSED = ('nbgrader', 'nbgrader.utils', 'requests')
"""Imported by nbgrader's database, but not used by it: `utils` imports setuptools."""
FORMATS = (
    *('fqdn', 'idna', 'isoduration', 'jsonpointer', 'rfc3339_validator', 'rfc3986_validator'),
    *('rfc3987', 'rfc3987_syntax', 'uri_template', 'webcolors'),
)
"""jsonschema imports these to check times, addresses and colors, but only if a schema names such
formats: ours do not, nor do nbformat's."""


class _LazyModule(ModuleType):
    """A module whose code runs when one of its names is used first.

    With importlib's LazyLoader, the next import of it, or of a module in it, would run the code.
    """

    def __getattr__(self, name: str) -> Any:
        in_it = '__path__' in vars(self) and importlib.util.find_spec(f'{self.__name__}.{name}')
        if in_it or name == '__path__':
            raise AttributeError(name)  # makes Python import the submodule
        spec = self.__spec__
        assert spec  # set by leave_out_servers
        assert spec.loader
        self.__class__ = ModuleType  # type: ignore[assignment]
        spec.loader.exec_module(self)
        return getattr(self, name)


@contextmanager
def pause_garbage_collection() -> Iterator[None]:
    """Turn off garbage collection during imports; afterwards, it ignores what was imported."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def leave_out_servers() -> None:
    """Delay the import of the UNUSED modules, unless this process has imported them."""
    for name in UNUSED:
        spec = None if name in sys.modules else importlib.util.find_spec(name)
        if spec is None:
            continue
        module = _LazyModule(name)
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
