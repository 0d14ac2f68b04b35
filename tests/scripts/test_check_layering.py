"""scripts/check-layering passes this tree and catches each kind of violation."""
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "check-layering"

CLEAN = {
    "model/map.h": "#include <stdint.h>\n",
    "model/map.c": '#include "model/map.h"\n',
    "model/side.h": "#include <stdbool.h>\n",
    "controller/law.h": '#include "model/map.h"\n',
    "controller/law.c": '#include "controller/law.h"\n#include <string.h>\n',
    "hal/bus.h": '#include "model/side.h"\n#include <stdbool.h>\n',
    "hal/port_stm32g474/chip.c": '#include "hal/port_fdcan/fdcan.h"\n',
    "hal/port_fdcan/fdcan.h": "#include <stdint.h>\n",
    "hal/port_linux/port.h": '#include "hal/bus.h"\n',
    "hal/port_linux/port.c": '#include "hal/port_linux/port.h"\n#include <sys/socket.h>\n',
    "firmware/task.c": '#include "controller/law.h"\n#include "hal/bus.h"\n',
    "firmware/board/main.c": '#include "hal/port_linux/port.h"\nint main(void)\n{\n}\n',
    "sim_host/plant/walker.c": '#include "model/map.h"\n#include <math.h>\n',
    "sim_host/plant/walker_internal.h": '#include "sim_host/plant/walker.h"\n',
    "sim_host/plant/walker.h": "#include <stdint.h>\n",
    "sim_host/plant/walker_parts.c": '#include "sim_host/plant/walker_internal.h"\n',
    "sim_host/study/laws/basin.c": '#include "sim_host/loop/loop.h"\n',
    "sim_host/loop/loop.h": '#include "sim_host/plant/walker.h"\n',
    "sim_host/programs/walk.c": '#include "hal/port_linux/port.h"\nint main(void)\n{\n}\n',
    "sim_host/programs/command.c": '#include "hal/port_linux/port.h"\nint command(void)\n{\n}\n',
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
    ("sim_host/loop/bad.c", '#include "hal/port_linux/port.h"\n', "only a file with main()"),
    ("sim_host/cli/bad.c", '#include "hal/port_linux/port.h"\n', "only a file with main()"),
    ("sim_host/loop/bad.c", '#include "tests/hal/test_port.c"\n', "sim_host/loop/ must not know tests/"),
    ("sim_host/plant/bad.c", '#include "sim_host/loop/loop.h"\n', "sim_host/plant/ must not know sim_host/loop/"),
    ("sim_host/study/bad.c", '#include "sim_host/loop/loop.h"\n', "sim_host/study/ must not know sim_host/loop/"),
    ("sim_host/bad.c", "", "lies in no room of the table"),
    ("sim_host/drawer/bad.c", "", "lies in no room of the table"),
    ("hal/port_fdcan/bad.c", '#include "hal/port_linux/port.h"\n', "only a file with main()"),
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


def test_modules_that_include_each_other_are_caught(tmp_path):
    lay_out(tmp_path, CLEAN)
    lay_out(tmp_path, {"hal/a.h": "#include <stdint.h>\n", "hal/b.h": "#include <stdint.h>\n",
                       "hal/c.h": "#include <stdint.h>\n",
                       "hal/a.c": '#include "hal/a.h"\n#include "hal/b.h"\n',
                       "hal/b.c": '#include "hal/b.h"\n#include "hal/c.h"\n'})
    assert "0 violations" in run(tmp_path).stdout
    lay_out(tmp_path, {"hal/c.c": '#include "hal/c.h"\n#include "hal/a.h"\n'})
    result = run(tmp_path)
    assert result.returncode == 1
    assert result.stdout.splitlines()[0] == "circle: hal/a -> hal/b -> hal/c"


PARTS = {
    "hal/device_internal.h": "void device_send(int x);\nint device_next(void);\nextern const int device_table[];\n",
    "hal/device.c": '#include "hal/device_internal.h"\n\nint device_run(void)\n{\n    return device_next();\n}\n',
    "hal/device_errors.c": '#include "hal/device_internal.h"\n\nint device_next(void)\n{\n    return 1;\n}\n',
}


def test_a_type_that_is_called_like_a_function_is_no_use_of_it(tmp_path):
    lay_out(tmp_path, CLEAN | PARTS)
    lay_out(tmp_path, {"hal/device_errors.c": PARTS["hal/device_errors.c"] + "struct device_run *hook;\n"})
    assert "0 violations" in run(tmp_path).stdout


def test_files_that_use_each_other_behind_a_shared_header_are_caught(tmp_path):
    lay_out(tmp_path, CLEAN | PARTS)
    assert "0 violations" in run(tmp_path).stdout
    found = "circle of uses: hal/device.c -> hal/device_errors.c"
    for addition in ("void device_send(int x)\n{\n    (void)x;\n}\n", "const int device_table[] = {1};\n",
                     "struct long_type *\ndevice_send(int (*hook)(int),\n            int x)\n{\n}\n"):
        name = "device_table" if "table" in addition else "device_send"
        lay_out(tmp_path, {"hal/device.c": PARTS["hal/device.c"] + addition,
                           "hal/device_errors.c": f"int device_next(void)\n{{\n    return {name} != 0;\n}}\n"})
        result = run(tmp_path)
        assert (result.returncode, result.stdout.splitlines()[0]) == (1, found)


def test_a_name_that_is_only_mentioned_or_static_is_no_use(tmp_path):
    lay_out(tmp_path, CLEAN | PARTS)
    lay_out(tmp_path, {
        "hal/device.c": PARTS["hal/device.c"] + "void device_send(int x)\n{\n    (void)x;\n}\n",
        "hal/device_errors.c": '/* device_send() is for others */\nstatic const char *name = "device_send";\n'
                               "int device_next(void)\n{\n    return it.device_send + it->device_send;\n}\n"})
    assert "0 violations" in run(tmp_path).stdout
    lay_out(tmp_path, {"hal/device_errors.c": "static int device_send(int x)\n{\n    return x;\n}\n\n"
                                              "int device_next(void)\n{\n    return device_send(1);\n}\n"})
    assert "0 violations" in run(tmp_path).stdout


def test_a_row_that_names_a_later_one_is_caught(tmp_path):
    lay_out(tmp_path, CLEAN)
    script = tmp_path / "check-layering"
    script.write_text(SCRIPT.read_text().replace('"sim_host/bus": ("hal",)', '"sim_host/bus": ("hal", "sim_host/plant")'))
    done = subprocess.run(["/usr/bin/python3", script, tmp_path / "."], capture_output=True, text=True, timeout=60)
    assert "sim_host/bus/ names sim_host/plant/, which does not stand above it" in done.stdout


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
