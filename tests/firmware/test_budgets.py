"""The flashed image against its budgets: flash, RAM, stack, and what must not be in it."""
import json
import pathlib
import re
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
ARM = ROOT / "build" / "arm"
BOARDS = sorted(path.parent.name for path in (ROOT / "firmware/boards").glob("*/board.mk"))
OBJECTS = ARM / "obj/cortex_m4f"
FLASH_BYTES = 128 * 1024
RAM_BYTES = 16 * 1024
STACK_BYTES = 2 * 1024
TICK_INSTRUCTIONS = 12000


def run(*command):
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout


def image(board):
    return ARM / f"afo-{board.replace('_', '-')}.elf"


def sections(path):
    sizes = {}
    for line in run("arm-none-eabi-size", "-A", str(path)).splitlines():
        match = re.match(r"(\.\S+)\s+(\d+)\s+\d+$", line)
        if match:
            sizes[match.group(1)] = int(match.group(2))
    return sizes


def symbols(path):
    return [line.split()[-2:] for line in run("arm-none-eabi-nm", str(path)).splitlines()]


@pytest.fixture(scope="module", params=BOARDS)
def board(request):
    assert image(request.param).exists(), "make firmware"
    return request.param


def test_flash(board):
    sizes = sections(image(board))
    used = sum(sizes.get(name, 0) for name in (".starter", ".vectors", ".program_header", ".text", ".ARM.exidx", ".data"))
    print(f"{board}: {used} bytes of flash")
    assert used <= FLASH_BYTES


def test_static_ram(board):
    sizes = sections(image(board))
    used = sum(sizes.get(name, 0) for name in (".data", ".bss", ".noinit", ".crash"))
    print(f"{board}: {used} bytes of static RAM besides the black box")
    assert used <= RAM_BYTES
    assert sizes[".blackbox"] == 64 * 1024


def test_stack():
    report = json.loads(run("scripts/stack-depth", str(OBJECTS), "--json"))
    for board in BOARDS:
        depth = report[board]["thread"]["bytes"]
        print(f"{board}: {depth} bytes of stack, {report[board]['handler']['bytes']} in handlers")
        assert depth <= STACK_BYTES
        assert report[board]["handler"]["bytes"] <= 1024  # firmware/boards/sections.ld


def test_the_stack_the_linker_gives_is_the_budget():
    script = (ROOT / "firmware/boards/sections.ld").read_text()
    thread = re.search(r"THREAD_STACK = (\d+) \+ 32;", script)
    assert int(thread.group(1)) == STACK_BYTES
    assert int(re.search(r"FLASH_BUDGET = (\d+);", script).group(1)) == FLASH_BYTES
    assert int(re.search(r"RAM_BUDGET = (\d+);", script).group(1)) == RAM_BYTES


def test_what_must_not_be_in_the_image(board):
    forbidden = re.compile(
        r"^(malloc|free|calloc|realloc|_?sbrk.*|_malloc_r|v?s?n?f?i?printf|_vf.*printf.*|puts|exit|abort|"
        r"__aeabi_d\w+|__(add|sub|mul|div)df3|__aeabi_(f2d|i2d|ui2d|l2d|ul2d)|sin|cos|acos|sqrt|pow|exp|"
        r"longjmp|setjmp|__cxa.*|_impure_.*)$")
    assert [name for _, name in symbols(image(board)) if forbidden.match(name)] == []


def test_model_and_controller_have_no_mutable_data():
    objects = [p for room in ("model", "controller") for p in (OBJECTS / room).rglob("*.o")]
    assert len(objects) > 15
    for path in objects:
        for kind, name in symbols(path):
            assert kind not in "bBdDC", f"{path.name}: {name}"
        sizes = sections(path)
        assert sum(v for k, v in sizes.items() if k.startswith((".data", ".bss"))) == 0, path.name


def test_both_boards_are_linked_from_the_same_objects():
    def used(board):
        text = (ARM / f"afo-{board.replace('_', '-')}.map").read_text()
        return set(re.findall(r"build/arm/obj/\w+/((?:model|controller|firmware|hal)/[\w/]+\.o)", text))

    both = used(BOARDS[0]) & used(BOARDS[1])
    only = (used(BOARDS[0]) | used(BOARDS[1])) - both
    assert "controller/controller.o" in both and "firmware/control_task.o" in both
    assert all("port_" in name or "boards/" in name for name in only), only


@pytest.mark.parametrize("change, says", [
    ("int depth(int n);\nint depth(int n) { return n > 0 ? depth(n - 1) + n * (int)(long)&n : n; }\n", "recursion"),
    ("int size(int n);\nint size(int n) { char a[n]; a[0] = (char)n; return *(volatile char *)a; }\n", "unknown size"),
    ("int call(int (*f)(int));\nint call(int (*f)(int)) { return f(1) + 1; }\n", "whom it reaches"),
    ("int call(void *bus);\nstruct bus { int (*send)(int); };\n"
     "int call(void *bus)\n{\n    const struct bus *b = bus;\n    return b->send(1) + 1;\n}\n", "nobody that \"send\""),
])
def test_the_stack_check_notices(tmp_path, change, says):
    """A function that breaks a rule, reached from main, must be told."""
    name = re.match(r"int (\w+)\(", change).group(1)
    source = tmp_path / "seed.c"
    source.write_text(change + f"int main(void) {{ return {name}({'0' if name == 'call' else '3'}); }}\n"
                      "void tim2_handler(void) {}\nvoid fdcan1_handler(void) {}\nvoid timer0_handler(void) {}\n"
                      "void report(void) {}\n")
    subprocess.run(["arm-none-eabi-gcc", "-mcpu=cortex-m4", "-mthumb", "-O1", "-fno-inline",
                    "-fno-optimize-sibling-calls", "-fcallgraph-info=su", "-c", str(source), "-o",
                    str(tmp_path / "seed.o")], check=True, cwd=tmp_path)
    result = subprocess.run(["scripts/stack-depth", str(tmp_path)], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 1
    assert says in result.stderr


def test_the_object_of_a_file_that_has_moved_does_not_count(tmp_path):
    """An incremental build leaves it; its functions would be there twice."""
    shutil.copytree(OBJECTS, tmp_path / "obj")
    report = json.loads(run("scripts/stack-depth", str(OBJECTS), "--json"))
    old = tmp_path / "obj" / "firmware" / "zz_old_place"
    for suffix in (".ci", ".d"):
        text = (OBJECTS / f"firmware/orthosis{suffix}").read_text().replace("firmware/orthosis.c", "firmware/zz_old_place.c")
        old.with_suffix(suffix).write_text(re.sub(r'(label: "orthosis_poll[^"]*?)\d+ bytes', r"\g<1>9000 bytes", text))
    assert "9000 bytes" in old.with_suffix(".ci").read_text()
    assert json.loads(run("scripts/stack-depth", str(tmp_path / "obj"), "--json")) == report
    old.with_suffix(".d").unlink()
    result = subprocess.run(["scripts/stack-depth", str(tmp_path / "obj"), "--json"], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode != 0 or json.loads(result.stdout) != report, "without its source's name it counts"


def test_the_budgets_command_and_the_page_have_these_limits():
    command = (ROOT / "scripts/budgets").read_text()
    limits = [int(n) for n in re.findall(r'": (\d+)[,}]', command)]
    assert limits == [FLASH_BYTES, RAM_BYTES, STACK_BYTES, TICK_INSTRUCTIONS]
    page = (ROOT / "firmware/README.md").read_text()
    rows = re.findall(r"^\| [a-zA-Z ,.()16]+ \| ([\d,]+)[ a-z]* \|$", page, re.MULTILINE)
    assert [int(row.replace(",", "")) for row in rows] == limits
