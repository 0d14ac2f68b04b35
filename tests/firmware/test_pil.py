"""The same object code on an emulated Cortex-M4F: it walks, its frames are the host's
bit for bit, and every fault of the device ends in the safe state with the right record."""
import json
import pathlib
import re
import shutil
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "system"))

import gait_play  # noqa: E402
from afo import recording  # noqa: E402
from made_gait import made_gait  # noqa: E402

PIL = ROOT / "build" / "afo"
TICK_INSTRUCTIONS = 12000
PREDICTIVE_TICK_INSTRUCTIONS = 48000
CLOCK_HZ = 170e6

pytestmark = pytest.mark.skipif(shutil.which("qemu-system-arm") is None, reason="qemu-system-arm is not installed")

# enum crash_cause in hal/storage/crash_record.h, enum supervisor_state in controller/supervisor/supervisor.h
CRASH_NONE, CRASH_MEMORY_FAULT, CRASH_BUS_FAULT, CRASH_ASSERTION, CRASH_WATCHDOG = 0, 3, 4, 7, 9
STATE_FAULT = 6


def pil(*options, status=0):
    result = subprocess.run([str(PIL), "pil", "--json", *options], cwd=ROOT, capture_output=True, text=True, timeout=400)
    assert result.returncode == status, result.stdout + result.stderr
    return json.loads(result.stdout) if result.stdout else None


def test_two_hundred_steps_bit_for_bit(tmp_path):
    walk = pil("--steps", "200", "--speed", "0.8", "--costs", str(tmp_path / "costs.csv"))
    assert walk["steps"] >= 200 and not walk["fell"]
    assert walk["differences"] == 0
    assert walk["compared_frames"] > 190000
    print(f"worst tick {walk['worst_tick_instructions']} instructions, mean {walk['mean_tick_instructions']}, "
          f"stack never used {walk['stack_unused_bytes']} bytes, {walk['wall_s']} s")
    assert walk["worst_tick_instructions"] <= TICK_INSTRUCTIONS
    assert walk["stack_unused_bytes"] >= 64
    lines = (tmp_path / "costs.csv").read_text().splitlines()
    assert len(lines) >= walk["ticks"] - 2
    # The first line is the start-up before the first tick; all others are ticks.
    assert max(int(line.split(",")[1]) for line in lines[1:]) == walk["worst_tick_instructions"]


@pytest.mark.parametrize("speed, steps", [("0.8", "60"), ("0.3", "12")])
def test_the_predictive_law_within_its_budget_bit_for_bit(speed, steps):
    """The walk starts at 0.41 rad/s and the command jumps: the search is at its longest."""
    walk = pil("--steps", steps, "--speed", speed, "--law", "predictive")
    assert walk["steps"] >= int(steps) and not walk["fell"]
    assert walk["differences"] == 0
    print(f"worst tick {walk['worst_tick_instructions']} instructions, mean {walk['mean_tick_instructions']}")
    assert walk["worst_tick_instructions"] <= PREDICTIVE_TICK_INSTRUCTIONS
    assert walk["mean_tick_instructions"] * 1000 <= 0.3 * CLOCK_HZ
    assert walk["stack_unused_bytes"] >= 64


def test_the_stack_that_a_walk_touches_is_within_the_call_graphs_bound():
    """The longest path of the graph is the predictive law's, which is walked."""
    walk = pil("--steps", "20", "--speed", "0.3", "--law", "predictive")
    objects = ROOT / "build/arm/obj/cortex_m4f"
    bound = json.loads(subprocess.run([ROOT / "scripts/stack-depth", objects, "--json"], cwd=ROOT, capture_output=True, text=True,
                                      check=True).stdout)["mps2_an386"]["thread"]["bytes"]
    names = subprocess.run(["arm-none-eabi-nm", ROOT / "build/arm/afo-mps2-an386.elf"], capture_output=True, text=True,
                           check=True).stdout
    at = {name: int(re.search(rf"^(\w+) \w thread_stack_{name}$", names, re.MULTILINE).group(1), 16) for name in ("bottom", "top")}
    touched = at["top"] - at["bottom"] - walk["stack_unused_bytes"]
    print(f"stack: {touched} bytes touched, {bound} by the call graph")
    # Touched more than half of the bound, the walk says something of it.
    assert bound / 2 < touched <= bound


def test_the_adult_too():
    walk = pil("--steps", "20", "--person", "sim_host/persons/adult70.ini", "--device", "sim_host/devices/virtual-adult.ini")
    assert walk["steps"] >= 20 and walk["differences"] == 0
    assert walk["worst_tick_instructions"] <= TICK_INSTRUCTIONS


@pytest.mark.parametrize("sensors", ["14bit", "17bit"])
def test_late_and_noisy_sensors(sensors):
    """One count of noise, 2 ms late: tests/system/test_observed.py says what is known then."""
    walk = pil("--steps", "40", "--speed", "0.8", "--sensors", sensors, "--sensor-noise", "1", "--sensor-latency", "2")
    assert walk["steps"] >= 40 and not walk["fell"] and walk["differences"] == 0
    assert walk["worst_tick_instructions"] <= TICK_INSTRUCTIONS


@pytest.fixture(name="person", params=["made", pytest.param("recorded", marks=pytest.mark.data)])
def walk_of_a_person(request, tmp_path):
    if request.param == "recorded":
        return recording()
    return gait_play.write(tmp_path / "made.csv", made_gait(20.0))


def test_a_person(person, tmp_path):
    """The rules, law and timing for a person, on the first 20 s of a walk (see tests/system/test_recording.py)."""
    part = tmp_path / "part.csv"
    part.write_text("".join(person.read_text(encoding="utf-8").splitlines(keepends=True)[:4001]), encoding="utf-8")
    walk = pil("--recording", str(part))
    assert walk["steps"] >= 30 and walk["differences"] == 0
    assert walk["worst_tick_instructions"] <= TICK_INSTRUCTIONS


@pytest.mark.parametrize("frame", ["1", "3000"])
def test_one_changed_bit_is_noticed(frame):
    walk = pil("--steps", "3", "--corrupt", frame, status=1)
    assert walk["differences"] >= 1


@pytest.mark.parametrize("fault, latched, crash", [
    ("emergency-stop", "emergency stop", CRASH_NONE),
    ("lost-sensor", "leg sensor silent", CRASH_NONE),
    ("lost-drive", "drive silent", CRASH_NONE),
    ("hang", "restarted by itself", CRASH_WATCHDOG),
    ("stalled-supervisor", "restarted by itself", CRASH_WATCHDOG),
    ("hard-fault", "restarted by itself", CRASH_BUS_FAULT),
    ("stack-overflow", "restarted by itself", CRASH_MEMORY_FAULT),
    ("execute-ram", "restarted by itself", CRASH_MEMORY_FAULT),
    ("write-program", "restarted by itself", CRASH_MEMORY_FAULT),
    ("assertion", "restarted by itself", CRASH_ASSERTION),
    ("bad-parameters", "bad parameters", CRASH_NONE),
])
def test_faults_end_in_the_safe_state(fault, latched, crash):
    """afo pil itself checks that both springs are unloaded at the end."""
    walk = pil("--fault", fault, "--speed", "0.45")
    assert walk["fault"] == latched
    assert walk["state"] == STATE_FAULT
    assert walk["crash_cause"] == crash
    assert walk["starts"] == (2 if crash else 1)
    assert walk["differences"] == 0
    if fault != "stalled-supervisor":  # there the image waits a millisecond a tick
        assert walk["worst_tick_instructions"] <= TICK_INSTRUCTIONS
    if crash:
        assert walk["crash_count"] == 1
        assert walk["black_box_state"] >= 1  # the reset did not clear it


@pytest.mark.parametrize("options, fault_bits", [
    (["--steps", "8"], 0),                       # frozen by whoever asks for it
    (["--fault", "emergency-stop"], 1 << 1),     # by the fault
    (["--fault", "hard-fault"], 1 << 17),        # by the start after the reset, which did not clear it
])
def test_the_black_box_replays_from_the_middle(tmp_path, options, fault_bits):
    """Fetched over SDO from the image, replayed by the host's build of the same code."""
    log = tmp_path / "box.log"
    walk = pil(*options, "--speed", "0.8", "--black-box", str(log))
    assert walk["black_box_fault_bits"] == fault_bits
    assert walk["worst_tick_instructions"] <= TICK_INSTRUCTIONS
    replay = [str(ROOT / "build" / "afo"), "replay", "--speed", "0.8"]
    result = subprocess.run([*replay, str(log)], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
    ticks = int(re.search(r"(\d+) ticks; all (\d+) frames", result.stdout).group(1))
    assert ticks > 1500
    assert f"recorded by build {walk['build_id']:08x}" in result.stdout
    assert "from the middle of a walk" in result.stdout
    # One bit of a target position two thirds through must be told with its place.
    lines = log.read_text().splitlines()
    targets = [i for i, line in enumerate(lines) if " 201#" in line]
    place = targets[2 * len(targets) // 3]
    lines[place] = lines[place][:-1] + format(int(lines[place][-1], 16) ^ 1, "X")
    log.write_text("\n".join(lines) + "\n")
    result = subprocess.run([*replay, str(log)], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 1 and f"line {place + 1}" in result.stdout


def slcan(*options, status=0):
    result = subprocess.run([str(ROOT / "build" / "afo"), "slcan", "--json", "--speed", "0.8", *options], cwd=ROOT,
                            capture_output=True, text=True, timeout=900)
    assert result.returncode == status, result.stdout + result.stderr
    return json.loads(result.stdout)


@pytest.mark.parametrize("steps", [1, pytest.param(5, marks=pytest.mark.long)])
def test_a_short_walk_over_slcan(steps):
    """The same image on a board without a CAN controller: every frame through the UART."""
    walk = slcan("--steps", str(steps))
    assert walk["walked"] and walk["steps"] >= steps
    assert walk["differences"] == 0
    assert walk["compared_frames"] > 1000
    assert walk["syncs"] == walk["ticks"]
    # A SYNC is t0800 and CR, its acknowledgement z and CR: the frames did pass through the line.
    assert walk["bytes_in"] > 6 * walk["ticks"] and walk["bytes_out"] > 60 * (walk["ticks"] - 700)


@pytest.mark.long
def test_one_changed_bit_on_the_line_is_noticed():
    assert slcan("--steps", "1", "--corrupt", "900", status=1)["differences"] >= 1


def test_the_image_names_its_build():
    walk = pil("--steps", "1", "--speed", "0.45")
    version = subprocess.run([str(PIL), "pil", "--version"], capture_output=True, text=True, check=True).stdout
    assert f"{walk['build_id']:08x}" in version


def test_a_missing_image_is_told():
    result = subprocess.run([str(PIL), "pil", "--image", "nowhere.elf"], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 2
    assert "nowhere.elf" in result.stderr
