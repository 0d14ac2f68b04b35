"""scripts/check-layering passes this tree and catches each kind of violation."""
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "check-layering"

CLEAN = {
    "model/map.h": "#include <stdint.h>\n",
    "model/map.c": '#include "model/map.h"\n',
    "controller/law.h": '#include "model/map.h"\n',
    "controller/law.c": '#include "controller/law.h"\n#include <string.h>\n',
    "hal/bus.h": "#include <stdbool.h>\n",
    "hal/port_linux/port.h": '#include "hal/bus.h"\n',
    "hal/port_linux/port.c": '#include "hal/port_linux/port.h"\n#include <sys/socket.h>\n',
    "firmware/task.c": '#include "controller/law.h"\n#include "hal/bus.h"\n',
    "firmware/board/main.c": '#include "hal/port_linux/port.h"\nint main(void)\n{\n}\n',
    "sim_host/plant/walker.c": '#include "model/map.h"\n#include <math.h>\n',
    "sim_host/programs/walk.c": '#include "hal/port_linux/port.h"\nint main(void)\n{\n}\n',
    "tests/hal/test_port.c": '#include "hal/port_linux/port.h"\n#include <check.h>\n',
    "Makefile": "",
    ".gitignore": "",
}

VIOLATIONS = [
    ("model/bad.c", '#include "controller/law.h"\n', "model/ must not know controller/"),
    ("model/bad.c", '#include "hal/bus.h"\n', "model/ must not know hal/"),
    ("controller/bad.c", '#include "hal/bus.h"\n', "controller/ must not know hal/"),
    ("controller/deep/bad.c", '#  include "sim_host/plant/walker.c"\n', "must not know sim_host/"),
    ("hal/bad.h", '#include "controller/law.h"\n', "hal/ must not know controller/"),
    ("hal/bad.h", '#include "model/map.h"\n', "hal/ must not know model/"),
    ("firmware/bad.c", '#include "model/map.h"\n', "firmware/ must not know model/"),
    ("firmware/bad.c", '#include "sim_host/plant/walker.c"\n', "firmware/ must not know sim_host/"),
    ("firmware/bad.c", '#include "hal/port_linux/port.h"\n', "only a file with main()"),
    ("sim_host/bad.c", '#include "hal/port_linux/port.h"\n', "only a file with main()"),
    ("sim_host/bad.c", '#include "tests/hal/test_port.c"\n', "sim_host/ must not know tests/"),
    ("hal/bad.c", "#include <sys/socket.h>\n", "freestanding"),
    ("controller/bad.c", "#include <math.h>\n", "freestanding"),
    ("model/bad.c", "#include <stdlib.h>\n", "freestanding"),
    ("firmware/bad.c", "#include <stdio.h>\n", "freestanding"),
    ("model/bad.c", '#include "map.h"\n', "from the top of the tree"),
    ("model/bad.c", '#include "../hal/bus.h"\n', "from the top of the tree"),
    ("model/bad.c", '#include "model/absent.h"\n', "no such file"),
    ("notes.txt", "", "does not belong at the top level"),
]


def run(tree):
    return subprocess.run([SCRIPT, tree], capture_output=True, text=True, timeout=60)


def lay_out(tree, files):
    for name, text in files.items():
        path = tree / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def test_this_tree_is_clean():
    result = run(ROOT)
    assert result.returncode == 0, result.stdout


def test_a_clean_tree_passes(tmp_path):
    lay_out(tmp_path, CLEAN)
    result = run(tmp_path)
    assert result.returncode == 0, result.stdout


def test_an_empty_tree_does_not_pass(tmp_path):
    assert run(tmp_path).returncode == 1


@pytest.mark.parametrize("name,text,why", VIOLATIONS)
def test_a_violation_is_caught(tmp_path, name, text, why):
    lay_out(tmp_path, CLEAN)
    lay_out(tmp_path, {name: text})
    result = run(tmp_path)
    assert result.returncode == 1
    findings = result.stdout.splitlines()[:-1]
    assert len(findings) == 1
    assert findings[0].startswith(name)
    assert why in findings[0]
