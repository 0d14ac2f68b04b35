"""memcpy, memmove and memset of the image, run in the Unicorn engine and compared with Python's bytes: any length,
any alignment, and not a byte beside."""
import functools
import pathlib
import random
import subprocess

import pytest

unicorn = pytest.importorskip("unicorn")
from unicorn import arm_const  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
ELF = ROOT / "build/arm/afo-nucleo-g474re.elf"
BIN = ROOT / "build/arm/afo-nucleo-g474re.bin"
FLASH, RAM, BYTES, ROOM = 0x08000000, 0x20000000, 0x20000, 4096
RETURN = RAM + BYTES - 16


@functools.cache
def address(name):
    lines = subprocess.run(["arm-none-eabi-nm", str(ELF)], capture_output=True, text=True, check=True).stdout.splitlines()
    return next(int(line.split()[0], 16) for line in lines if line.split()[-1] == name)


@pytest.fixture(scope="module")
def core():
    engine = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
    engine.mem_map(FLASH, 0x80000)
    engine.mem_map(RAM, BYTES)
    engine.mem_write(FLASH, BIN.read_bytes())

    def call(name, *arguments):
        saved = {}
        for register, value in zip((arm_const.UC_ARM_REG_R0, arm_const.UC_ARM_REG_R1, arm_const.UC_ARM_REG_R2), arguments):
            engine.reg_write(register, value)
        for register in range(arm_const.UC_ARM_REG_R4, arm_const.UC_ARM_REG_R4 + 8):
            saved[register] = random.getrandbits(32)
            engine.reg_write(register, saved[register])
        engine.reg_write(arm_const.UC_ARM_REG_SP, RAM + BYTES - 64)
        engine.reg_write(arm_const.UC_ARM_REG_LR, RETURN | 1)
        engine.emu_start(address(name) | 1, RETURN, count=100000)
        assert engine.reg_read(arm_const.UC_ARM_REG_PC) == RETURN, "it does not come back"
        assert engine.reg_read(arm_const.UC_ARM_REG_R0) == arguments[0]
        assert all(engine.reg_read(register) == value for register, value in saved.items()), "a register of the caller's"
        return engine

    return engine, call


CASES = [(length, to, source) for length in (0, 1, 3, 4, 5, 31, 32, 33, 63, 64, 100, 257, 1000)
         for to in range(4) for source in range(4)]


@pytest.mark.parametrize("name", ["memcpy", "memmove"])
def test_what_is_copied_is_all_and_no_more(core, name):
    engine, call = core
    random.seed(1)
    for length, to, source in CASES:
        memory = bytearray(random.randbytes(2 * ROOM))
        engine.mem_write(RAM, bytes(memory))
        call(name, RAM + 64 + to, RAM + ROOM + source, length)
        memory[64 + to:64 + to + length] = memory[ROOM + source:ROOM + source + length]
        assert engine.mem_read(RAM, 2 * ROOM) == memory, (length, to, source)


def test_memory_is_filled(core):
    engine, call = core
    random.seed(2)
    for length, to, value in CASES:
        memory = bytearray(random.randbytes(ROOM))
        engine.mem_write(RAM, bytes(memory))
        call("memset", RAM + 64 + to, value * 85, length)
        memory[64 + to:64 + to + length] = bytes([value * 85]) * length
        assert engine.mem_read(RAM, ROOM) == memory, (length, to, value)


@pytest.mark.parametrize("way", [-40, -4, -1, 1, 4, 40])
def test_parts_that_overlap_are_moved(core, way):
    engine, call = core
    random.seed(3)
    memory = bytearray(random.randbytes(ROOM))
    engine.mem_write(RAM, bytes(memory))
    call("memmove", RAM + 500 + way, RAM + 500, 200)
    memory[500 + way:700 + way] = memory[500:700]
    assert engine.mem_read(RAM, ROOM) == memory
