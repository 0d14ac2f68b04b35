"""The hazard table's check notices what it is there for."""
import pathlib
import re
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def check(tree):
    return subprocess.run([ROOT / "scripts/check-safety", tree], capture_output=True, text=True)


def test_the_table_is_complete():
    result = check(ROOT)
    assert result.returncode == 0, result.stdout


@pytest.fixture
def copy(tmp_path):
    for part in ("controller/SAFETY.md", "sim_host/faults/fault_kinds.h"):
        (tmp_path / part).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / part, tmp_path / part)
    shutil.copytree(ROOT / "tests", tmp_path / "tests", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


@pytest.mark.parametrize("old, new, told", [
    (r":limits_hold_for_any_sequence_of_targets", ":nobody_tests_this", "no test of that name"),
    (r"tests/hal/test_watchdog\.c", "tests/hal/test_nothing.c", "no such test file"),
    (r"campaign:PUSH", "campaign:SHOVE", "no such class"),
    (r"(\| H5 \|[^|]*\|[^|]*\|)[^|]*\|", r"\1 |", "has no test"),
    (r"(\| H6 \|[^|]*\|)[^|]*\|", r"\1 |", "mitigation"),
    (r"\| H\d+ \|", "| no |", "no hazard"),
    (r"\| H6 \|", "| H5 |", "H5 stands there twice"),
    (r"(\| R5 \|[^|]*\|[^|]*\|)[^|]*\|", r"\1 H4, H99 |", "there is no row H99"),
    (r"(\| R5 \|[^|]*\|[^|]*\|)[^|]*\|", r"\1 |", "no row named"),
    (r"(\| R5 \|[^|]*\|)[^|]*\|", r"\1 |", "requirement"),
])
def test_a_gap_is_found(copy, old, new, told):
    page = copy / "controller/SAFETY.md"
    text = page.read_text()
    changed = re.sub(old, new, text)
    assert changed != text
    page.write_text(changed)
    result = check(copy)
    assert result.returncode == 1
    assert told in result.stdout
