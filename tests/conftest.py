"""Which tests a machine can run: those marked `data` need recordings that belong to other people.

AFO_DATA names the folder that holds them. Where it is unset, those tests are not registered, and the
summary says how many there are. A folder that AFO_DATA names must be there.
"""
import os
import pathlib

import pytest

NOT_REGISTERED = pytest.StashKey[int]()


def pytest_configure(config):
    folder = os.environ.get("AFO_DATA")
    if folder and not pathlib.Path(folder).is_dir():
        raise pytest.UsageError(f"AFO_DATA={folder}: no such folder")
    config.stash[NOT_REGISTERED] = 0


@pytest.hookimpl(trylast=True)  # behind the choice by -m and -k: what that leaves out is not missing
def pytest_collection_modifyitems(config, items):
    if os.environ.get("AFO_DATA"):
        return
    missing = [item for item in items if item.get_closest_marker("data")]
    if missing:
        items[:] = [item for item in items if item not in missing]
        config.hook.pytest_deselected(items=missing)
        config.stash[NOT_REGISTERED] = len(missing)


def pytest_terminal_summary(terminalreporter, config):
    if config.stash[NOT_REGISTERED]:
        terminalreporter.write_line(f"not registered for want of AFO_DATA: {config.stash[NOT_REGISTERED]}")
