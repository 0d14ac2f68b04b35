"""Where the files of this tree are, in the tree or where they were installed."""
import pathlib

HERE = pathlib.Path(__file__).resolve().parent


def _first(name):
    for path in (HERE.parents[1] / "hal/canopen/eds" / name, HERE / "eds" / name):
        if path.is_file():
            return path
    raise FileNotFoundError(f"{name} is neither in hal/canopen/eds nor beside the server")


def eds_path():
    return _first("controller.eds")


def dbc_path():
    return _first("afo.dbc")
