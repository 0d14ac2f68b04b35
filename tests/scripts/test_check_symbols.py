"""scripts/check-symbols passes this tree and catches each kind of violation."""
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "check-symbols"

CLEAN = {
    "model/a.c": "float half(float x);\nfloat half(float x)\n{\n    return 0.5f * x;\n}\n",
    "controller/b.c": "float half(float x);\nfloat quarter(float x);\n"
                      "float quarter(float x)\n{\n    return half(half(x)) + __builtin_sqrtf(x);\n}\n",
    # Constant tables, block moves and 64-bit division are what the core may have.
    "hal/c.c": "#include <stdint.h>\n#include <string.h>\n"
               "extern const int table[3];\nconst int table[3] = {1, 2, 3};\n"
               "uint64_t ratio(const void *from, uint64_t by);\n"
               "uint64_t ratio(const void *from, uint64_t by)\n"
               "{\n    uint64_t value[40];\n    memcpy(value, from, sizeof value);\n"
               "    return value[by % 40] / by;\n}\n",
    "hal/port_x/d.c": "#include <stdio.h>\nvoid shout(void);\nvoid shout(void)\n{\n    puts(\"x\");\n}\n",
}

VIOLATIONS = [
    ("model", "#include <stdlib.h>\nvoid *f(void)\n{\n    return malloc(8);\n}\n", "allocator: malloc"),
    ("firmware", "#include <stdlib.h>\nvoid f(void *p)\n{\n    free(p);\n}\n", "allocator: free"),
    ("hal", "#include <stdio.h>\nvoid f(int x)\n{\n    printf(\"%d\", x);\n}\n", "printf family: printf"),
    ("hal", "#include <stdio.h>\nvoid f(char *s, int x)\n{\n    snprintf(s, 3, \"%d\", x);\n}\n",
     "printf family: snprintf"),
    ("controller", "double f(double x)\n{\n    return x * x;\n}\n", "double arithmetic: __aeabi_dmul"),
    ("controller", "float f(double x)\n{\n    return (float)x;\n}\n", "double arithmetic: __aeabi_d2f"),
    ("firmware", "int f(double x, double y)\n{\n    return x < y;\n}\n", "double arithmetic: __aeabi_dcmplt"),
    ("firmware", "double f(int x)\n{\n    return x;\n}\n", "double arithmetic: __aeabi_i2d"),
    ("model", "#include <math.h>\nfloat f(float x)\n{\n    return sinf(x);\n}\n", "libm: sinf"),
    ("controller", "#include <math.h>\nfloat f(float x)\n{\n    return atan2f(x, 2.0f);\n}\n", "libm: atan2f"),
    ("controller", "static int calls;\nint f(void)\n{\n    return ++calls;\n}\n", "mutable global 'calls'"),
    ("model", "int f(void)\n{\n    static int calls = 3;\n    return ++calls;\n}\n", "mutable global 'calls"),
    ("model", "int shared;\nint f(void)\n{\n    return shared;\n}\n", "mutable global 'shared'"),
    ("hal", "int elsewhere(void);\nint f(void)\n{\n    return elsewhere();\n}\n",
     "undefined symbol: elsewhere"),
    ("hal", "int f(void)\n{\n    return 1 +;\n}\n", "does not compile"),
    ("sim_host/plant", "#include <math.h>\ndouble f(double x)\n{\n    return sin(x);\n}\n", "libm"),
    ("sim_host/nodes", "#include <math.h>\nfloat f(float x)\n{\n    return powf(x, 0.3f);\n}\n", "libm"),
]


def run(tree):
    return subprocess.run([SCRIPT, tree], capture_output=True, text=True, timeout=300)


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


@pytest.mark.parametrize("room,text,why", VIOLATIONS)
def test_a_violation_is_caught(tmp_path, room, text, why):
    lay_out(tmp_path, CLEAN)
    lay_out(tmp_path, {f"{room}/bad.c": text})
    result = run(tmp_path)
    assert result.returncode == 1
    findings = [line for line in result.stdout.splitlines() if f"{room}/bad.c" in line]
    assert findings and any(why in line for line in findings), result.stdout
