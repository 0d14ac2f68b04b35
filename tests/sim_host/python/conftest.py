"""The assembled package, as build/python holds it; another module of that name may be loaded beside it."""
import importlib
import os
import sys

import pytest

from package_tree import BUILD


def own(names):
    return [name for name in names if name.split(".")[0] == "afo"]


@pytest.fixture(scope="session")
def afo():
    """The package; make python-package assembles it."""
    others = {name: sys.modules.pop(name) for name in own(list(sys.modules))}
    sys.path.insert(0, str(BUILD / "python"))
    try:
        return importlib.import_module("afo")
    finally:
        sys.path.pop(0)
        for name in own(list(sys.modules)):
            del sys.modules[name]
        sys.modules.update(others)


@pytest.fixture(scope="session")
def environment():
    """For a process that imports the package."""
    return {**os.environ, "PYTHONPATH": str(BUILD / "python")}
