"""afo study table's C source: it compiles, and its speeds are the gaits' that afo study finds."""
import json
import os
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
BUILD = pathlib.Path(os.environ.get("AFO_BUILD", ROOT / "build")).resolve()


def table(*arguments):
    return subprocess.run([BUILD / "afo", "study", "table", *map(str, arguments)], capture_output=True, text=True, timeout=60)


def numbers(source):
    values = [float(value) for value in re.findall(r"REAL\(([-+0-9.e]+)\)", source)]
    return values[0], values[1], values[2:]


@pytest.mark.parametrize("body", [(), ("--M", 65, "--m", 2.5, "--l", 0.93, "--k", 7000)], ids=["paper", "adult"])
def test_entries_are_fixed_points(body):
    first, step, speeds = numbers(table(*body).stdout)
    assert len(speeds) == 64
    for entry in (0, 9, 33, 63):
        found = subprocess.run([BUILD / "afo", "study", "fixed-point", *map(str, body), "--r0",
                                repr(first + entry * step), "--json"], capture_output=True, text=True, timeout=60)
        assert -json.loads(found.stdout)["x"][0] == pytest.approx(speeds[entry], rel=1e-9)


def test_the_source_compiles(tmp_path):
    (tmp_path / "table.c").write_text(table("--name", "some_name").stdout)
    done = subprocess.run(["gcc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-I", ROOT, "-c", "table.c"], cwd=tmp_path,
                          capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("arguments", [("--M", "nan"), ("--k", "x"), ("--from", 0.3, "--to", 0.2), ("duplicate_id_count",)])
def test_bad_arguments(arguments):
    done = table(*arguments)
    assert done.returncode == 2
    assert "afo study table: " in done.stderr and done.stdout == ""


def test_a_full_disk_is_noticed():
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run([BUILD / "afo", "study", "table"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
    assert done.returncode == 2 and "write" in done.stderr
