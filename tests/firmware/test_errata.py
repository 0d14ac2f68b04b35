"""scripts/errata.txt: every row has a test that exists, and what the rows say of the image is so."""
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
IMAGE = ROOT / "build/arm/afo-nucleo-g474re.elf"
STARTER = ROOT / "build/arm/starter/starter.elf"
TABLE = ROOT / "scripts/errata.txt"
VERDICTS = {"handled", "avoided", "elsewhere"}
SHORTEST_HANDLER = 15  # instructions: a division or a root takes 14 cycles (Cortex-M4 TRM, table of FPU instructions)


def rows():
    lines = [line for line in TABLE.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    return [[cell.strip() for cell in line.split("|")] for line in lines]


@pytest.mark.parametrize("row", rows(), ids=lambda row: row[0])
def test_each_row_is_whole_and_names_a_test(row):
    assert len(row) == 6 and all(row) and row[2] in VERDICTS
    path, name = row[4].split(":")
    assert re.search(rf"(START_TEST\({name}\)|def {name}\()", (ROOT / path).read_text(encoding="utf-8")), row[4]


def disassembly(elf):
    assert elf.exists(), "make firmware"
    text = subprocess.run(["arm-none-eabi-objdump", "-d", "--no-show-raw-insn", str(elf)], capture_output=True, text=True,
                          check=True).stdout
    functions = {}
    for name, body in re.findall(r"^[0-9a-f]+ <([^>]+)>:\n((?:.+\n)+)", text, re.MULTILINE):
        functions[name] = [line.split("\t", 1)[1] for line in body.splitlines() if "\t" in line]
    return functions


@pytest.fixture(scope="module")
def code():
    return disassembly(IMAGE)


def test_no_instruction_loads_the_stack_pointer(code):
    assert len(code) > 200
    found = [(name, line) for name, lines in code.items() for line in lines if re.match(r"ldr(\.w)?\s+sp,|ldm\S*\s+\S+,\s*\{[^}]*\bsp\b", line)]
    assert not found


def test_handlers_are_long_and_end_with_a_barrier(code):
    for handler, work in (("tim2_handler", "tim2_clock_interrupt"), ("fdcan1_handler", "fdcan_interrupt"),
                          ("pvd_handler", "supply_interrupt")):
        lines = code[handler]
        ends = [i for i, line in enumerate(lines) if re.match(r"pop\S*\s.*pc|bx\s+lr|ldm\S*\s+sp!.*pc", line)]
        assert len(ends) == 1
        before = lines[:ends[0]]
        barrier = max(i for i, line in enumerate(before) if line.startswith("dsb"))
        assert not any(line.startswith(("str", "stm", "push")) for line in before[barrier:])
        assert len(before) + len(code.get(work, [])) > SHORTEST_HANDLER


def test_no_other_peripheral_is_used():
    """The registers that switch clocks on are written with these bits only."""
    text = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "hal/port_stm32g474").glob("*.c"))
    clocks = set(re.findall(r"RCC_A(?:HB|PB)\d_\w+", text))
    assert clocks == {"RCC_APB1_LPTIM1", "RCC_APB2_SYSCFG", "RCC_APB1_TIM2", "RCC_APB1_FDCAN", "RCC_APB1_PWR", "RCC_APB1_LPUART1", "RCC_AHB2_GPIOA", "RCC_AHB2_GPIOC"}
    assert set(re.findall(r"RCC_\w+ENR\d?", text)) == {"RCC_APB1ENR1", "RCC_APB1ENR2", "RCC_APB2ENR", "RCC_AHB2ENR"}


def test_neither_edge_filtering_nor_single_shot_is_asked_for():
    """RM0440, FDCAN_CCCR: EFBI is bit 13, DAR bit 6."""
    text = (ROOT / "hal/port_fdcan/fdcan_setup.c").read_text() + (ROOT / "hal/port_fdcan/fdcan.c").read_text()
    written = set(re.findall(r"put\(FDCAN_CCCR, ([^)]+)\)", text))
    assert written == {"0", "FDCAN_CCCR_INIT", "FDCAN_CCCR_INIT | FDCAN_CCCR_CCE"}


def test_a_barrier_follows_each_sleep(code):
    """Else the core may go on with a wrong instruction where a debugger has left DBGMCU_CR set, as openocd does."""
    sleeps = [(lines, i) for lines in code.values() for i, line in enumerate(lines) if line.startswith(("wfi", "wfe"))]
    assert sleeps and all(lines[i + 1].startswith("isb") for lines, i in sleeps)


def test_no_first_store_to_a_ram_matters():
    """The starter's first instructions, by a reading of their own: no stack; each RAM is touched before it counts."""
    lines = disassembly(STARTER)["starter_reset"]
    registers, stores, loads = {}, [], []
    for operation, *operands in (re.split(r"[\s,]+", line.split("@")[0].strip()) for line in lines):
        if operation.startswith("mov"):
            registers[operands[0]] = int(operands[1].lstrip("#"), 0)
        elif operation == "orr.w":
            registers[operands[0]] = registers[operands[1]] | int(operands[2].lstrip("#"), 0)
        elif operation in ("str", "ldr"):
            (stores if operation == "str" else loads).append(registers[operands[1].strip("[]")])
        else:
            assert operation in ("dsb", "b.n", "b.w"), operation
    assert stores == [0x20000000, 0x20000000] and loads == [0x20008000, 0x20010000, 0x20014000]
