"""Where the tree and its build are."""
import os
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[3]
BUILD = pathlib.Path(os.environ.get("AFO_BUILD", ROOT / "build")).resolve()
