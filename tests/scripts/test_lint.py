"""scripts/lint notices what it is there for: one seeded finding per check."""
import pathlib
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

HEADER = "int probe(const int *values, int count);\n"
CLEAN = """#include "model/probe.h"

int probe(const int *values, int count)
{
    int sum = 0;
    for (int i = 0; i < count; i++) {
        sum += values[i];
    }
    return sum;
}
"""
SEEDED = {
    "layout": (CLEAN.replace("    int sum", "  int sum"), "model/probe.c"),
    "cppcheck": (CLEAN.replace("int sum = 0", "int pair[2] = {0, 0};\n    int sum = pair[2]"), "arrayIndexOutOfBounds"),
    # 15.1: goto should not be used; not among the deviations.
    "misra": (CLEAN.replace("    return sum;", "    goto end;\nend:\n    return sum;"), "rule 15.1"),
    "tidy": (CLEAN.replace("int sum = 0;", "int sum = 0;\n    int again = sum == 3 ? 1 : 1;\n    sum += again;")
             .replace("values[i];", "values[i];\n        sum += sizeof(values) / sizeof(values[0]) > 5;"), "bugprone"),
    "analyzer": (CLEAN.replace("#include", "#include <stdlib.h>\n#include", 1)
                 .replace("int sum = 0;", "int sum = 0;\n    int *lost = malloc(8);\n    *lost = 3;"), "analyzer"),
    "layering": ('#include "hal/nothing.h"\n' + CLEAN, "model/ must not know hal/"),
    "symbols": (CLEAN.replace("int sum = 0;", "static int calls;\n    int sum = ++calls;"), "mutable global"),
}


@pytest.fixture
def tree(tmp_path):
    for name in ("scripts", ".clang-format", ".clang-tidy"):
        (shutil.copytree if (ROOT / name).is_dir() else shutil.copy)(ROOT / name, tmp_path / name)
    for room in ("model", "tests"):
        (tmp_path / room).mkdir()
    (tmp_path / "model" / "probe.h").write_text(HEADER)
    (tmp_path / "model" / "probe.c").write_text(CLEAN)
    return tmp_path


def lint(tree, *checks):
    return subprocess.run([tree / "scripts" / "lint", *checks], capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize("check", SEEDED)
def test_a_seeded_finding_is_reported(tree, check):
    if check != "misra":  # in a tree this small its deviations are idle, which it reports as well
        clean = lint(tree, check)
        assert clean.returncode == 0, clean.stdout
    text, word = SEEDED[check]
    (tree / "hal").mkdir()
    (tree / "hal" / "nothing.h").write_text("")  # what is not there is another finding
    (tree / "model" / "probe.c").write_text(text)
    done = lint(tree, check)
    assert done.returncode == 1
    assert f"FAIL  {check}" in done.stdout and word in done.stdout, done.stdout


@pytest.mark.parametrize("name,text", [
    ("probe", "#!/usr/bin/env bash\nif true; then\n"), ("probe", "#!/bin/sh\ncase x in\n"),
    ("probe", "#!/usr/bin/python3\ndef f(:\n"), ("probe.py", "x = (\n")])
def test_a_script_that_does_not_parse_is_reported(tree, name, text):
    assert lint(tree, "scripts").returncode == 0
    (tree / "scripts" / name).write_text(text)
    (tree / "scripts" / name).chmod(0o644 if name.endswith(".py") else 0o755)
    done = lint(tree, "scripts")
    assert done.returncode == 1 and "probe" in done.stdout, done.stdout


def test_this_tree_passes_the_quick_checks():
    """The rest takes minutes: `make lint`. Layering and symbols have tests of their own."""
    done = lint(ROOT, "layout", "scripts")
    assert done.returncode == 0, done.stdout


def test_an_idle_deviation_is_reported(tree):
    done = lint(tree, "misra")
    assert done.returncode == 1 and "excuses nothing any more" in done.stdout
