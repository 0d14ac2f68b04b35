"""The supervisor in the very image that is flashed, on the Unicorn engine: every state under every combination of
conditions, latched or not. What leads to WALKING, what leaves a fault, and how soon the torque is off."""
import collections
import pathlib
import re
import struct
import subprocess

import pytest

unicorn = pytest.importorskip("unicorn")
arm = pytest.importorskip("unicorn.arm_const")

ROOT = pathlib.Path(__file__).resolve().parents[2]
IMAGE = ROOT / "build/arm/afo-nucleo-g474re.elf"
FLASH, RAM, STACK, RETURN = 0x08000000, 0x20000000, 0x20007000, 0x08000000
MACHINE = RAM + 0x100
STEPS_MOST = 2000  # instructions of one tick: some 20 for each of 20 rows

INIT, SELF_TEST, STANDBY, ENGAGING, WALKING, UNLOADING, FAULT, COMMISSIONING = STATES = range(8)
ASSISTING = {ENGAGING, WALKING}
TORQUE = {ENGAGING, WALKING, UNLOADING, COMMISSIONING}
(IF_FAULT, IF_NODES, IF_PLAUSIBLE, IF_WALK, IF_ENABLED, IF_STEPPING, IF_UNLOADED, IF_TIMEOUT, IF_RESET, IF_STANDSTILL,
 IF_LATCHED, IF_STEADY, IF_REGULAR, IF_MOTION) = (1 << bit for bit in range(14))
# The function itself says whether a fault is latched.
CONDITIONS = [c for c in range(1 << 14) if not c & IF_LATCHED]
STOP, FALL = 1, 7  # reasons: an emergency stop now, and a fall that was latched before


class Chip:
    def __init__(self):
        names = subprocess.run(["arm-none-eabi-nm", IMAGE], capture_output=True, text=True, check=True).stdout
        self.at = {name: int(at, 16) for at, name in re.findall(r"^(\w+) \w (supervisor_\w+)$", names, re.MULTILINE)}
        self.engine = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
        self.engine.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4)
        self.engine.mem_map(FLASH, 0x40000)
        self.engine.mem_write(FLASH, IMAGE.with_suffix(".bin").read_bytes())
        self.engine.mem_map(RAM, 0x8000)

    def call(self, name, *arguments):
        for number, value in enumerate(arguments):
            self.engine.reg_write(arm.UC_ARM_REG_R0 + number, value)
        self.engine.reg_write(arm.UC_ARM_REG_MSP, STACK)
        self.engine.reg_write(arm.UC_ARM_REG_LR, RETURN | 1)
        self.engine.emu_start(self.at[name] | 1, RETURN, count=STEPS_MOST)
        assert self.engine.reg_read(arm.UC_ARM_REG_PC) == RETURN

    def step(self, state, latched, conditions):
        """(state, reason latched) after one tick."""
        self.engine.mem_write(MACHINE, struct.pack("<II", state, latched))
        self.call("supervisor_update_f32", MACHINE, 1000, conditions, STOP if conditions & IF_FAULT else 0)
        return self.machine()

    def machine(self):
        return struct.unpack("<II", self.engine.mem_read(MACHINE, 8))

    def steps(self, states):
        return {(state, latched): [self.step(state, latched, conditions) for conditions in CONDITIONS]
                for state in states for latched in (0, FALL) if (state, latched) != (FAULT, 0)}


@pytest.fixture(scope="module", name="steps")
def all_steps():
    chip = Chip()
    chip.call("supervisor_force_fault_f32", MACHINE, FALL)
    assert chip.machine() == (FAULT, FALL)  # the two words that step() writes
    return chip.steps(STATES)


def reached(steps, never=0, closed=None):
    """Places (state, whether a fault is latched) that can come, with the ticks that each takes at least."""
    found = {(INIT, 0): 0, (FAULT, FALL): 0}
    waiting = collections.deque(found)
    while waiting:
        place = waiting.popleft()
        for conditions, (state, latched) in zip(CONDITIONS, steps[place]):
            after = state, FALL if latched else 0
            if not conditions & never and place[0] != closed and after not in found:
                found[after] = found[place] + 1
                waiting.append(after)
    return found


def walks(steps, **how):
    return any(state == WALKING for state, _ in reached(steps, **how))


def ticks_until_off(steps):
    """The most ticks from a fault in any state to torque off, where the fault and the end of the time last."""
    most = 0
    for start in ((state, 0) for state in TORQUE):
        now, ticks = {start}, 0
        while any(state in TORQUE for state, _ in now):
            now = {(state, FALL if latched else 0) for place in now
                   for conditions, (state, latched) in zip(CONDITIONS, steps[place])
                   if conditions & IF_FAULT and conditions & IF_TIMEOUT}
            ticks += 1
            if ticks > len(STATES) * 2:
                return float("inf")
        most = max(most, ticks)
    return most


def wrong_ways(steps):
    """What is not as it must be; empty when all is well."""
    wrong = [name for name, never in (("nodes", IF_NODES), ("self test", IF_PLAUSIBLE), ("request", IF_WALK), ("drives", IF_ENABLED),
                                      ("steady steps", IF_STEADY)) if walks(steps, never=never)]
    wrong += [f"not through state {state}" for state in (SELF_TEST, STANDBY, ENGAGING) if walks(steps, closed=state)]
    if {state for state, _ in reached(steps, never=IF_WALK | IF_MOTION)} & TORQUE:
        wrong.append("torque that nobody asked for")
    if STANDBY in {state for state, _ in reached(steps, never=IF_PLAUSIBLE)}:
        wrong.append("ready without a self test")
    if {(state, FALL) for state in ASSISTING} & set(reached(steps)):
        wrong.append("assists with a latched fault")
    for place, ways in steps.items():
        for conditions, (state, latched) in zip(CONDITIONS, ways):
            if place[0] == FAULT and state != FAULT and \
                    (state != INIT or conditions & (IF_RESET | IF_STANDSTILL | IF_FAULT) != IF_RESET | IF_STANDSTILL):
                wrong.append("a fault left without a reset at standstill")
            if place[1] and not latched and place[0] != FAULT:
                wrong.append("a fault forgotten")
            if state == FAULT and not latched:
                wrong.append("FAULT without a reason")
            if conditions & IF_FAULT and (state in ASSISTING or (state in TORQUE and place[0] not in TORQUE)):
                wrong.append("torque or springs with a fault")
    if ticks_until_off(steps) > 2:
        wrong.append("torque lasts")
    return sorted(set(wrong))


def test_every_state_can_come_and_walking_takes_its_steps(steps):
    found = reached(steps)
    assert {state for state, _ in found} == set(STATES)
    assert found[WALKING, 0] == 4  # INIT, SELF_TEST, STANDBY, ENGAGING: a tick each at least


def test_no_way_is_wrong(steps):
    assert wrong_ways(steps) == []


# Rows of the table as the image holds it: from, require, forbid in two bytes each, two to align, the target in four.
ROW, REQUIRE = 12, 2


@pytest.mark.parametrize("row, state, require, noticed", [
    (0, ENGAGING, IF_FAULT | IF_TIMEOUT, "torque or springs with a fault"),
    (3, UNLOADING, IF_UNLOADED | IF_RESET, "assists with a latched fault"),
    (10, INIT, 0, "nodes"),
    (11, SELF_TEST, 0, "ready without a self test"),
    (13, STANDBY, IF_PLAUSIBLE, "torque that nobody asked for"),
    (14, ENGAGING, IF_STEADY, "drives"),
    (14, ENGAGING, IF_ENABLED, "steady steps"),
    (15, FAULT, IF_STANDSTILL, "a fault left without a reset at standstill"),
    (16, UNLOADING, IF_TIMEOUT | IF_RESET, "torque lasts")])
def test_a_changed_row_of_the_image_is_noticed(steps, row, state, require, noticed):
    chip = Chip()
    at = chip.at["supervisor_rows_f32"] + ROW * row
    from_states, before = struct.unpack("<HH", chip.engine.mem_read(at, 4))
    assert from_states & 1 << state and before != require
    chip.engine.mem_write(at + REQUIRE, struct.pack("<H", require))
    assert noticed in wrong_ways({**steps, **chip.steps([state])})
