"""hal/port_cortex_m/core_test.c as the image has it, on the Unicorn engine: each stuck bit of each register and of
each tested word is found, and what was there before is there afterwards."""
import pathlib
import re
import subprocess

import pytest

unicorn = pytest.importorskip("unicorn")
arm = pytest.importorskip("unicorn.arm_const")

ROOT = pathlib.Path(__file__).resolve().parents[2]
IMAGE = ROOT / "build/arm/afo-nucleo-g474re.elf"
FLASH, RAM, STACK, RETURN = 0x08000000, 0x20000000, 0x20007000, 0x08000000
CORE = [f"R{i}" for i in range(13)] + ["LR"]
KEPT = [f"R{i}" for i in range(4, 12)]


@pytest.fixture(scope="module")
def image():
    assert IMAGE.exists(), "make firmware"
    names = subprocess.run(["arm-none-eabi-nm", str(IMAGE)], capture_output=True, text=True, check=True).stdout
    return IMAGE.with_suffix(".bin").read_bytes(), {name: int(at, 16) for at, _, name in re.findall(r"^(\w+) (\w) (core_test_\w+)$", names, re.M)}


class Core:
    def __init__(self, code):
        self.engine = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
        self.engine.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4)
        self.engine.mem_map(FLASH, 0x40000)
        self.engine.mem_write(FLASH, code)
        self.engine.mem_map(RAM, 0x8000)
        self.engine.mem_map(0xE000E000, 0x1000)
        self.stick = lambda: None
        self.engine.hook_add(unicorn.UC_HOOK_BLOCK, lambda *_: self.stick())

    def register(self, name):
        return getattr(arm, f"UC_ARM_REG_{name}")

    def read(self, name):
        if name.startswith("S"):
            number = int(name[1:])
            return self.engine.reg_read(self.register(f"D{number // 2}")) >> 32 * (number % 2) & 0xFFFFFFFF
        return self.engine.reg_read(self.register(name))

    def write(self, name, value):
        if name.startswith("S"):
            number = int(name[1:])
            other = self.read(f"S{number ^ 1}")
            pair = (value, other) if number % 2 == 0 else (other, value)
            self.engine.reg_write(self.register(f"D{number // 2}"), pair[1] << 32 | pair[0])
        else:
            self.engine.reg_write(self.register(name), value)

    def call(self, address, argument=0):
        self.stick_now, self.stick = self.stick, lambda: None
        for i, name in enumerate(KEPT):
            self.write(name, 0x1000 + i)
        self.write("MSP", STACK)
        self.write("R0", argument)
        self.write("LR", RETURN | 1)
        self.stick = self.stick_now
        self.engine.emu_start(address | 1, RETURN, count=3000)
        self.stick = lambda: None
        return self.read("R0")


@pytest.fixture
def core(image):
    return Core(image[0])


def test_sound_registers_pass_and_are_kept(core, image):
    for name in ("core_test_registers", "core_test_low_floats", "core_test_high_floats"):
        for number in range(16, 32):
            core.write(f"S{number}", number)
        assert core.call(image[1][name]) == 0
        assert [core.read(name) for name in KEPT] == [0x1000 + i for i in range(8)] and core.read("MSP") == STACK
        assert [core.read(f"S{number}") for number in range(16, 32)] == list(range(16, 32))


# LR and R0 carry the way back and the verdict: with those stuck the core is lost, not the test.
@pytest.mark.parametrize("test, names", [
    ("core_test_registers", CORE[1:13]),
    ("core_test_low_floats", [f"S{i}" for i in range(16)]),
    ("core_test_high_floats", [f"S{i}" for i in range(16, 32)])])
@pytest.mark.parametrize("level", [0, 1])
def test_each_stuck_bit_is_found(core, image, test, names, level):
    for name in names:
        for bit in range(32):
            def stick(mask=1 << bit, name=name):
                now = core.read(name)
                core.write(name, now | mask if level else now & ~mask)
            core.stick = stick
            assert core.call(image[1][test]) & 1 == 1, (name, bit)


@pytest.mark.parametrize("at", [RAM + 0x100, STACK - 20, STACK - 8])
def test_sound_memory_passes_and_is_kept_even_below_the_stack(core, image, at):
    before = bytes(range(7, 23))
    core.engine.mem_write(at, before)
    assert core.call(image[1]["core_test_ram"], at) == 0
    assert [core.read(name) for name in KEPT] == [0x1000 + i for i in range(8)]
    assert at != RAM + 0x100 or bytes(core.engine.mem_read(at, 16)) == before


@pytest.mark.parametrize("level", [0, 1])
def test_each_stuck_bit_of_memory_is_found(core, image, level):
    at = RAM + 0x200
    for word in range(4):
        for bit in range(32):
            def stick(place=at + 4 * word, mask=1 << bit):
                now = int.from_bytes(core.engine.mem_read(place, 4), "little")
                core.engine.mem_write(place, (now | mask if level else now & ~mask).to_bytes(4, "little"))
            core.stick = stick
            assert core.call(image[1]["core_test_ram"], at) == 1, (word, bit)
