"""Logs of the bus and trials of `afo view`, as tables with all signals by tick."""
from __future__ import annotations

import json
import os
import pathlib
import subprocess
import sys
import tempfile
from typing import Any

import pandas as pd

from ._library import SYSTEM, AfoError
from .walking import PathLike, devices, find_file, persons


def _export(what: pathlib.Path, options: list[str]) -> pd.DataFrame:
    try:
        import pyarrow.parquet as parquet
    except ImportError as error:
        raise AfoError(f"{error}; reading logs and trials needs it: pip install pyarrow cantools") from None
    with tempfile.TemporaryDirectory(prefix="afo-") as folder:
        out = pathlib.Path(folder) / "signals.parquet"
        done = subprocess.run([str(SYSTEM / "bin/afo"), "report", str(what), "--export", "parquet", "--out", str(out), *options],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
                              env={**os.environ, "AFO_PYTHON": sys.executable})
        if done.returncode != 0:
            raise AfoError(done.stderr.strip() or f"afo report ended with {done.returncode}, and said nothing")
        table = parquet.read_table(out)
    frame: pd.DataFrame = table.to_pandas()
    said: dict[bytes, bytes] = table.schema.metadata or {}
    frame.attrs["provenance"] = json.loads(said.get(b"provenance", b"{}"))
    frame.attrs["events"] = json.loads(said.get(b"events", b"[]"))
    frame.attrs["units"] = {field.name: (field.metadata or {}).get(b"unit", b"").decode() for field in table.schema}
    return frame


def read_trial(folder: PathLike) -> pd.DataFrame:
    """All signals of a trial, a row a tick.

    folder: what `afo view` recorded. Columns: tick, time (s), and the signals of the view's charts, such as
    leg_angle_left; in attrs: units (column to unit), events (a dict each: marks, steps, faults), provenance (subject,
    device, versions, parameters). A signal that was not on the bus yet is NaN. Raises AfoError where it is no trial.
    """
    path = pathlib.Path(folder)
    if not path.is_dir():
        raise AfoError(f"{path} is no folder of a trial; a log is read by read_log()")
    return _export(path, [])


def read_log(file: PathLike, person: PathLike | None = None, device: PathLike | None = None) -> pd.DataFrame:
    """All signals of a log of the bus, as read_trial() gives them.

    file: as `candump -L` or `afo sim --log` writes it. person, device: who walked with what, by name or path; the log
    does not tell. Raises AfoError where the file is no log.
    """
    path = pathlib.Path(file)
    if not path.is_file():
        raise AfoError(f"{path}: no such file" if not path.is_dir() else f"{path} is a folder; a trial is read by read_trial()")
    options: list[Any] = ["--log"]
    for name, found in (("--person", find_file("persons", persons(), person)),
                        ("--device", find_file("devices", devices(), device))):
        options += [name, found] if found is not None else []
    return _export(path, options)
