"""The very image that is flashed, in an emulated STM32G474: it walks, its frames are the host's and
replay bit for bit, and what goes wrong on a chip ends in the safe state with the right record."""
import json
import pathlib
import re
import struct
import subprocess
import sys
import zlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "system"))

import gait_play  # noqa: E402
from afo import recording  # noqa: E402
from made_gait import made_gait  # noqa: E402

AFO = ROOT / "build" / "afo"
ENGINE = list((ROOT / "build" / "venv").glob("lib/python3*/site-packages/unicorn/lib/libunicorn.so.2"))
CYCLES_OF_A_TICK = 170000
INSTRUCTIONS_OF_A_TICK = 12000  # the budget; interrupts and the loop's polls are among them here
# Four wait states and no cache: what an instruction of the image costs at most on average.
CYCLES_PER_INSTRUCTION = 4

pytestmark = pytest.mark.skipif(not ENGINE, reason="the Unicorn engine is not in build/venv (scripts/setup test)")

# enum crash_cause in hal/storage/crash_record.h, enum supervisor_state in controller/supervisor/supervisor.h
CRASH_NONE, CRASH_NMI, CRASH_MEMORY, CRASH_CLOCK_FAILED, CRASH_WATCHDOG, CRASH_LOST_WRITE = 0, 1, 3, 8, 9, 11
STATE_FAULT = 6


def g474(*options, status=0):
    result = subprocess.run([str(AFO), "g474", "--json", *options], cwd=ROOT, capture_output=True, text=True, timeout=900)
    assert result.returncode == status, result.stdout + result.stderr
    lines = [json.loads(line) for line in result.stdout.splitlines()]
    return lines[0] if len(lines) == 1 else lines or None


def test_a_walk_of_a_minute_equals_the_host_and_replays(tmp_path):
    log, costs = tmp_path / "walk.log", tmp_path / "costs.csv"
    walk = g474("--steps", "20", "--seconds", "60", "--speed", "0.8", "--log", str(log), "--costs", str(costs))
    assert walk["simulated_s"] >= 60 and walk["steps"] >= 20 and not walk["fell"]
    assert walk["differences"] == 0 and walk["compared_frames"] > 100000
    assert walk["findings"] == 0 and walk["starts"] == 1
    print(f"worst tick {walk['worst_tick_instructions']} instructions, {walk['wall_s']} s")
    assert walk["worst_tick_instructions"] * CYCLES_PER_INSTRUCTION <= CYCLES_OF_A_TICK
    assert walk["worst_tick_instructions"] <= INSTRUCTIONS_OF_A_TICK
    assert walk["sync_late_ns"] < 1000  # no SYNC waits for what is done now and then
    assert walk["permit_edges"] > walk["ticks"] // 2
    worst = max(int(line.split(",")[1]) for line in costs.read_text().splitlines())
    assert worst == walk["worst_tick_instructions"]
    replay = subprocess.run([str(AFO), "replay", "--speed", "0.8", str(log)], cwd=ROOT, capture_output=True, text=True)
    assert replay.returncode == 0, replay.stdout + replay.stderr
    assert int(re.search(r"(\d+) ticks; all \d+ frames", replay.stdout).group(1)) >= walk["ticks"] - 1


@pytest.mark.parametrize("device", ["ak80", "cia402", "epos4", "odrive"])
def test_a_device_of_others_walks_on_the_chip(device):
    """Their frames bunch where the bus is full: the phase of the chip's ticks is another one than the host's."""
    walk = g474("--steps", "3", "--speed", "0.8", "--device", f"sim_host/devices/{device}.ini")
    assert walk["steps"] == 3 and not walk["fell"] and walk["findings"] == 0
    assert walk["differences"] == 0 and walk["compared_frames"] > 5000
    # Frames that come by the drives' own clocks bunch by their phase, which any change of the image shifts: firmware/README.md.
    assert walk["worst_tick_instructions"] <= (13500 if device == "odrive" else INSTRUCTIONS_OF_A_TICK)


@pytest.fixture(name="person", params=["made", pytest.param("recorded", marks=pytest.mark.data)])
def walk_of_a_person(request, tmp_path):
    if request.param == "recorded":
        return recording()
    return gait_play.write(tmp_path / "made.csv", made_gait(20.0))


def test_a_person_walks_on_the_chip(person, tmp_path):
    """The first 20 s of a walk: the rules for a person cost more than those for a compass."""
    part = tmp_path / "part.csv"
    part.write_text("".join(person.read_text(encoding="utf-8").splitlines(keepends=True)[:4001]), encoding="utf-8")
    walk = g474("--recording", str(part))
    assert walk["steps"] >= 30 and walk["differences"] == 0 and walk["findings"] == 0
    assert walk["worst_tick_instructions"] <= INSTRUCTIONS_OF_A_TICK


def test_the_worst_tick_is_told_by_function(tmp_path):
    """Each new worst tick is in the file; the last is the worst of all."""
    profile = tmp_path / "profile.csv"
    walk = g474("--steps", "1", "--speed", "0.8", "--profile", str(profile))
    text = subprocess.run([str(ROOT / "scripts" / "tick-profile"), str(profile)], cwd=ROOT, capture_output=True, text=True,
                          check=True).stdout
    assert f"tick {walk['worst_tick']}: {walk['worst_tick_instructions']} instructions" in text
    rows = {line.split()[2]: line.split() for line in text.splitlines()[1:]}
    assert rows["controller_update_f32"][1] == "1" and int(rows["fdcan1_handler"][1]) >= 5
    assert sum(int(row[0]) for row in rows.values()) == walk["worst_tick_instructions"]


@pytest.mark.parametrize("frame", ["5", "3000"])
def test_one_changed_bit_is_noticed(frame):
    assert g474("--steps", "3", "--speed", "0.45", "--corrupt", frame, status=1)["differences"] >= 1


@pytest.mark.parametrize("fault, latched, crash, starts", [
    ("emergency-stop", ["emergency stop"], CRASH_NONE, 1),
    ("lost-sensor", ["leg sensor silent"], CRASH_NONE, 1),
    ("lost-drive", ["drive silent"], CRASH_NONE, 1),
    ("destroyed-frames", ["leg sensor silent", "drive silent", "drive fault", "node lost"], CRASH_NONE, 1),
    ("hang", ["restarted by itself"], CRASH_WATCHDOG, 2),
    ("crystal-stops", ["restarted by itself"], CRASH_CLOCK_FAILED, None),
    ("no-crystal", ["restarted by itself"], CRASH_CLOCK_FAILED, None),
    ("torn-settings", ["bad parameters"], CRASH_NONE, 1),
    ("ecc-error", ["restarted by itself", "bad parameters"], CRASH_NMI, 2),
])
def test_faults_end_in_the_safe_state(fault, latched, crash, starts):
    """afo g474 itself checks that both springs are unloaded at the end."""
    end = g474("--fault", fault, "--speed", "0.45", "--fault-step", "2")
    assert end["fault"] in latched
    assert end["state"] == STATE_FAULT
    assert end["crash_cause"] == crash
    assert end["starts"] == starts if starts else end["starts"] > 1
    assert end["differences"] == 0 and end["findings"] == 0


def test_the_torque_of_a_drive_that_hangs_is_taken_by_a_pin():
    """It holds a loaded spring. Silent for 10 ms, half a second more, K3 and the drive's input: 35 ms."""
    end = g474("--fault", "drive-hangs", "--speed", "0.45", "--fault-step", "2")
    assert end["fault"] == "drive silent" and end["state"] == STATE_FAULT and end["starts"] == 1
    assert 540 <= end["noticed_ms"] <= 560 and end["differences"] == 0 and end["findings"] == 0


def test_the_image_counts_its_own_cycles_and_tells_its_start_and_its_fault():
    """0x2020:28. The emulator takes one cycle an instruction and 24 an exception, some 12 of them in a tick."""
    end = g474("--fault", "emergency-stop", "--speed", "0.45", "--fault-step", "2")
    assert end["worst_tick_instructions"] < end["told_cycles"] < 1.2 * end["worst_tick_instructions"]
    start, fault = end["serial"].split("|")[:2]
    assert re.match(r"afo \d+\.\d+\.\d+\S* clock 170 MHz, option bytes FEEFFBAA, reset cause 0C000000, crash 00000000$", start)
    assert fault == "afo fault 0001" and end["led_edges"] > 10


@pytest.mark.parametrize("fault, crash", [
    ("ram-parity", 14), ("float-register", 15), ("slow-oscillator", 16), ("fast-oscillator", 16),
    ("deep-stack", 17), ("early-feed", CRASH_WATCHDOG), ("brown-out", 10), ("run-ram", CRASH_MEMORY),
    ("write-program", CRASH_MEMORY)])
def test_the_board_notices_its_own_faults_and_stays_safe(fault, crash):
    """firmware/README.md tells the longest times; here the fault lies where the test comes to soon."""
    end = g474("--fault", fault, "--speed", "0.45", "--fault-step", "2")
    assert end["crash_cause"] == crash and end["fault"] == "restarted by itself" and end["state"] == STATE_FAULT
    assert end["noticed_ms"] < 1500 and end["findings"] == 0


def test_a_register_that_sticks_ends_in_the_safe_state():
    """By the test or by what breaks down before it: test_core_test.py has each register and bit."""
    end = g474("--fault", "core-register", "--speed", "0.45", "--fault-step", "2")
    assert end["fault"] == "restarted by itself" and end["state"] == STATE_FAULT and end["noticed_ms"] < 1500


def test_a_cell_that_sticks_while_walking_is_noticed_and_the_board_stays_out_of_use():
    end = g474("--fault", "ram-slice", "--speed", "0.45", "--fault-step", "2")
    assert end["starts"] == 2 and "the RAM has failed" in end["serial"] and 0 < end["noticed_ms"] < 10000


def test_a_supply_that_falls_unloads_and_the_list_of_the_board_tells():
    end, board = g474("--fault", "supply-low", "--speed", "0.45", "--fault-step", "2", "--board")
    assert end["fault"] == "emergency stop" and end["starts"] == 1
    assert board["supply"] == {"good": False, "value": "above 2.9 V, 1 dips"}
    bad = {name for name, row in board.items() if not row["good"]}
    assert bad == {"supply"} and board["clock"]["value"] == "170000000 Hz" and len(board) == 13
    assert board["option bytes"]["value"] == "FEEFFBAA, wanted FEEFFBAA"


def test_a_round_of_each_test_takes_no_longer_than_the_table_says():
    """firmware/README.md, "A board's check-list". Registers and stacks: at the begin of each 64 of the RAM's slices."""
    table = (ROOT / "firmware/README.md").read_text(encoding="utf-8")
    walk, board = g474("--seconds", "33", "--steps", "20", "--speed", "0.8", "--board")
    slices = -(-0x8000 // 4 // 3) * 64 / 60
    for row, name in (("RAM while running", "RAM"), ("program memory", "program")):
        at_most_s = float(re.search(rf"^\| {row} \|[^|]*\| at most ([\d.]+) s \|", table, re.MULTILINE).group(1))
        rounds = int(re.search(r"tested (\d+) times", board[name]["value"]).group(1))
        assert rounds >= 1 and walk["simulated_s"] / rounds <= at_most_s * (rounds + 1) / rounds
    registers_s = float(re.search(r"^\| core registers, flags \|[^|]*\| at most ([\d.]+) s \|", table, re.MULTILINE).group(1))
    ram = int(re.search(r"tested (\d+) times", board["RAM"]["value"]).group(1))
    assert walk["simulated_s"] / ram / slices * 64 <= registers_s


def test_a_corrected_flash_error_is_counted_and_the_walk_goes_on():
    end = g474("--fault", "flash-corrected", "--speed", "0.45", "--fault-step", "2")
    assert end["corrected"] >= 1 and end["fault"] == "none" and end["starts"] == 1


def test_the_program_needs_nothing_of_what_the_starter_leaves_in_ram():
    """The starter's test of the RAM leaves it empty; a debugger's start does not."""
    end = g474("--fault", "dirty-ram", "--speed", "0.45", "--fault-step", "2")
    assert end["fault"] == "none" and end["differences"] == 0 and end["starts"] == 1


def test_a_lost_first_store_to_each_ram_does_no_harm():
    """scripts/errata.txt, system 2.2.7."""
    end = g474("--fault", "first-store", "--speed", "0.45", "--fault-step", "1")
    assert end["fault"] == "none" and end["differences"] == 0 and end["starts"] == 1


def test_a_mark_gives_a_pulse_at_once_wherever_it_comes_in_the_tick():
    """afo g474 itself checks that each mark has one pulse, and that the frames stay the host's."""
    end = g474("--fault", "mark", "--speed", "0.45", "--fault-step", "2")
    assert end["marks"] == 40 and end["differences"] == 0 and end["fault"] == "none"
    assert end["sync_late_ns"] < 8000  # a SYNC waits for the answer to one request at most
    assert end["worst_tick_instructions"] <= INSTRUCTIONS_OF_A_TICK
    assert 0 < end["mark_delay_us"][0] <= end["mark_delay_us"][1] < 100
    assert end["mark_delay_us"][1] - end["mark_delay_us"][0] < 50
    assert all(abs(length - 10000) <= 1 for length in end["pulse_us"])


def test_a_counter_that_is_read_leaves_the_tick_its_limit():
    """At the end the trial reads 0x2020:28: here beside telegrams and with the drives' care. It took 12,703."""
    end = g474("--fault", "mark", "--speed", "0.8", "--fault-step", "9")
    assert end["told_cycles"] > 0 and end["worst_tick_instructions"] <= INSTRUCTIONS_OF_A_TICK


@pytest.mark.parametrize("fault, options", [("first-start", "FEEFFBAA"), ("options-cut", "FFFFF8FF")])
def test_the_option_bytes_are_set_once_and_never_when_torn(fault, options):
    end = g474("--fault", fault)
    assert f"option bytes {options}" in end["serial"] and end["fault"] == "none"


@pytest.mark.parametrize("fault, starts", [("half-written", 1), ("damaged-program", 2)])
def test_a_program_that_is_not_whole_does_not_run_and_says_so(fault, starts):
    """Half of it erased before the start; one bit changed while it walks. The starter tells on LD2 and the COM port."""
    end = g474("--fault", fault, "--speed", "0.45", "--fault-step", "2")
    assert end["starts"] == starts and end["led_edges"] > 5
    assert "the program is not whole (CRC)" in end["serial"]


def test_ram_that_has_failed_is_noticed_before_the_program_runs():
    """One bit of 32 KiB stays 1."""
    end = g474("--fault", "stuck-ram")
    assert end["starts"] == 1 and "the RAM has failed" in end["serial"]


def test_the_sealed_header_is_what_an_independent_reading_finds():
    image = (ROOT / "build/arm/afo-nucleo-g474re.bin").read_bytes()[0x2000:]
    magic, hardware, version, _, length, _, _, crc = struct.unpack_from("<8I", image, 0x200)
    assert magic.to_bytes(4, "little") == b"AIMG" and hardware == 1 and length == len(image)
    base = re.search(r"^VERSION_BASE := (\d+)\.(\d+)\.(\d+)", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert [version >> 16, version >> 8 & 255, version & 255] == [int(part) for part in base.groups()]
    assert crc == zlib.crc32(image[:0x21C] + image[0x220:])


@pytest.mark.parametrize("register", [0x40000028, 0x40003008, 0x48000024, 0x4000641C])
def test_a_lost_write_at_the_start_is_noticed_and_told(register):
    """TIM2's prescaler, the watchdog's reload, alternate functions, FDCAN's bit timing. The record names it."""
    end = g474("--fault", "lost-write", "--lose", str(register), "--speed", "0.45")
    assert end["crash_cause"] == CRASH_LOST_WRITE and end["fault"] == "restarted by itself" and end["state"] == STATE_FAULT


@pytest.mark.parametrize("fault, every, latched", [("save-cut", 37, ["none"]), ("load-cut", 1, ["none", "bad parameters"])])
def test_power_may_fail_while_settings_are_written(fault, every, latched):
    """A save: old or new settings. "load" at 0x1011, which forgets them: those before, or none and it says so."""
    end = g474("--fault", fault, "--every", str(every))
    assert end["cuts"] == (end["flash_operations"] + every - 1) // every >= 4 and end["bad_cuts"] == 0
    assert end["fault"] in latched


@pytest.mark.parametrize("fault, cut", [("save-cut", 0), ("save-cut", 17), ("load-cut", 2)])
def test_power_fails_once(fault, cut):
    end = g474("--fault", fault, "--cut", str(cut))
    assert end["cut_hit"] and end["starts"] == 2


@pytest.mark.parametrize("fault, starts", [
    ("update-older", 2),        # a newer one is what update-cut sends
    ("update-other-board", 1),
    ("update-walking", 1),
])
def test_a_program_comes_over_can_or_is_refused_with_the_reason(fault, starts):
    """afo g474 itself checks the words of the refusal and which program runs in the end."""
    end = g474("--fault", fault, "--speed", "0.45", "--fault-step", "2")
    assert end["starts"] == starts and end["fault"] == "none" and end["findings"] == 0


def test_power_may_fail_while_a_program_is_received_ordered_and_installed():
    """The old or the new program runs afterwards; without a cut the new one."""
    end = g474("--fault", "update-cut", "--every", "1511")
    assert end["cuts"] >= 10 and end["bad_cuts"] == 0 and end["fault"] == "none"


@pytest.mark.long
def test_power_may_fail_all_over_an_update():
    """Each of these starts runs to its end, whatever another has read."""
    end = g474("--fault", "update-cut", "--every", "61")
    assert end["cuts"] == end["cuts_run"] > 250 and end["bad_cuts"] == 0


@pytest.mark.long
def test_power_may_fail_at_every_word_of_an_update():
    """A start from flash that reads the same as one before is not run again (tests/sim_host/emulator)."""
    end = g474("--fault", "update-cut", "--every", "1", "--alike")
    assert end["cuts"] == end["flash_operations"] > 25000 and end["bad_cuts"] == 0
    assert end["cuts_run"] < 100


def test_starts_that_read_the_same_flash_are_run_once():
    end = g474("--fault", "load-cut", "--every", "1", "--alike")
    assert 1 <= end["cuts_run"] <= end["cuts"] == end["flash_operations"] and end["bad_cuts"] == 0


@pytest.mark.long
def test_power_may_fail_at_every_word_of_a_save():
    end = g474("--fault", "save-cut", "--every", "1")
    assert end["cuts"] == end["flash_operations"] > 300 and end["bad_cuts"] == 0


@pytest.mark.long
def test_a_long_walk_with_the_predictive_law():
    walk = g474("--steps", "200", "--speed", "0.8", "--law", "predictive")
    assert walk["steps"] >= 200 and walk["differences"] == 0
    assert walk["worst_tick_instructions"] <= 48000


@pytest.mark.long
def test_every_broken_driver_is_noticed():
    result = subprocess.run([str(ROOT / "scripts" / "chip-in-the-loop"), "--only", "mutants"], cwd=ROOT,
                            capture_output=True, text=True)
    assert result.returncode == 0, result.stdout
    assert "19 broken drivers, 19 noticed" in result.stdout


def test_what_is_missing_is_told():
    for option, name in (("--image", "nowhere.bin"), ("--core", "./nowhere.so")):
        result = subprocess.run([str(AFO), "g474", option, name], cwd=ROOT, capture_output=True, text=True)
        assert result.returncode == 2 and "nowhere" in result.stderr
