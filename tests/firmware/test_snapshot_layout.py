"""A snapshot of the target restores on the host: every part of it has one size on both."""
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
ARM = ["arm-none-eabi-gcc", "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-fno-short-enums"]


def parts():
    """The fields that snapshot.c names, and the blocks it copies whole."""
    text = (ROOT / "firmware/snapshot.c").read_text()
    table = text[text.index("#define TASK_FIELDS(X)"):text.index("#define FIELD_SIZE")]
    fields = re.findall(r"X\(([\w.\[\]]+)\)", table)
    assert len(fields) > 20
    return [f"sizeof ((struct control_task *)0)->{field}" for field in fields] + [
        "sizeof(struct device_drives_state)", "PARAMS_GUARD_OWN_BYTES",
        "(sizeof(struct controller) - offsetof(struct controller, observer) + 7) / 8 * 8"]


def sizes(compiler, tmp_path, expressions):
    """Compile-time constants without running: as sizes of arrays."""
    source = tmp_path / "sizes.c"
    source.write_text('#include "firmware/control_task.h"\n#include "hal/devices/device_drives.h"\n' + "".join(
        f"char part_{i:03}[{expression}];\n" for i, expression in enumerate(expressions)))
    subprocess.run([*compiler, "-std=c11", f"-I{ROOT}", "-c", str(source), "-o", str(tmp_path / "sizes.o")], check=True)
    out = subprocess.run(["nm", "-S", str(tmp_path / "sizes.o")], capture_output=True, text=True, check=True).stdout
    found = {m.group(2): int(m.group(1), 16) for m in re.finditer(r"^\w+ (\w+) \w (part_\d+)$", out, re.MULTILINE)}
    return [found[f"part_{i:03}"] for i in range(len(expressions))]


def test_every_part_has_one_size(tmp_path):
    expressions = parts()
    host, target = sizes(["gcc"], tmp_path, expressions), sizes(ARM, tmp_path, expressions)
    assert [(e, h, t) for e, h, t in zip(expressions, host, target) if h != t] == []


def test_a_pointer_inside_would_be_noticed(tmp_path):
    expressions = ["sizeof(struct step_law)", "sizeof(struct { struct step_law law; void *at; })"]
    host, target = sizes(["gcc"], tmp_path, expressions), sizes(ARM, tmp_path, expressions)
    assert host[0] == target[0]
    assert host[1] != target[1]
