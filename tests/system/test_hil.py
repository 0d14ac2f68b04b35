"""The walk over a real CAN stack is the walk on the in-process bus, tick by tick."""
import json
import re
import subprocess

from afo import BUILD, ROOT


def test_twenty_steps_over_vcan_equal_the_in_process_walk(tmp_path):
    done = subprocess.run(["scripts/hil", "--steps", "20", "--build", str(BUILD), "--out", str(tmp_path)],
                          cwd=ROOT, capture_output=True, text=True, timeout=700)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^hil: \d+ ticks, none lost$", done.stdout, re.MULTILINE)
    assert re.search(r"^equal: ticks 1000 to \d+, 20 steps$", done.stdout, re.MULTILINE)
    # A record of the bus says who ran: the same as the in-process walk's log.
    told = [subprocess.run([BUILD / "afo", "replay", "--speed", "0.45", tmp_path / log], cwd=ROOT, capture_output=True,
                           text=True, timeout=300).stdout for log in ("sim.log", "vcan.log")]
    identity = re.search(r"^recorded by build [0-9a-f]{8}, parameter CRC [0-9a-f]{8}$", told[0], re.MULTILINE)
    assert identity and identity[0] in told[1], told


def test_the_other_drive_protocols_walk_over_vcan(tmp_path):
    """The plant's own apex speeds beside what the controller measured; nothing lost, nobody fallen."""
    devices = ("odrive", "ak80")
    script = "".join(f"""
        device=sim_host/devices/{device}.ini
        "{BUILD}/afo" walker --can vcan0 --device $device --silence 60000 --json >{tmp_path}/{device}.walker & walker=$!
        sleep 0.3
        "{BUILD}/afo" host --can vcan0 --device $device --speed 0.45 --steps 3 --answer-timeout 60000 --json \\
            >{tmp_path}/{device}.host || exit
        kill -TERM $walker; wait $walker || exit""" for device in devices)
    done = subprocess.run(["scripts/vcan-guest", "--timeout", "150", "--", "bash", "-c", script], cwd=ROOT,
                          capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stdout + done.stderr
    for device in devices:
        host = json.loads((tmp_path / f"{device}.host").read_text())
        walker = json.loads((tmp_path / f"{device}.walker").read_text())
        assert host["steps"] == 3 and host["fault"] == 0 and host["lost_cycles"] == 0, (device, host)
        assert walker["falls"] == 0 and walker["clock_ticks"] == 0, (device, walker)
        speed = walker["apex_speed_rad_s"]
        assert len(speed) == 3 and speed[0] < speed[1] < speed[2] < 0.45, (device, speed)
        assert abs(host["measured_speed_rad_s"] / speed[-1] - 1) < 0.002, (device, host, speed)


def log_of(path, ticks, steps, changes=None):
    """A log of ticks; step telemetry in the ticks given, other frames where changed."""
    lines = []
    for tick in range(ticks):
        frames = ["080#", "201#0100000002000000", "283#0102030405", "284#0102030405"]
        if tick in steps:
            frames.append(f"390#{steps.index(tick):02X}00000000000000")
        for at, old, new in changes or ():
            if at == tick:
                frames = [new if frame.startswith(old) else frame for frame in frames]
        lines += [f"(0000000001.{tick * 10 + i:06d}) can0 {frame}\n" for i, frame in enumerate(frames)]
    path.write_text("".join(lines))
    return path


def compare(*arguments):
    return subprocess.run(["scripts/compare-walks", *map(str, arguments)], cwd=ROOT,
                          capture_output=True, text=True, timeout=60)


def test_a_changed_frame_is_found(tmp_path):
    steps = [1100, 1300, 1500]
    whole = log_of(tmp_path / "whole.log", 1600, steps)
    same = compare(whole, whole, "--steps", 3)
    assert same.returncode == 0 and "ticks 1000 to 1500, 3 steps" in same.stdout
    for tick in (1000, 1499):
        changed = log_of(tmp_path / "changed.log", 1600, steps, [(tick, "201#", "201#0300000002000000")])
        found = compare(whole, changed)
        assert found.returncode == 1 and f"tick {tick}, frame 201" in found.stdout
    # Before the walk, and behind its last step, runs may differ.
    for tick in (999, 1501):
        changed = log_of(tmp_path / "changed.log", 1600, steps, [(tick, "201#", "201#0300000002000000")])
        assert compare(whole, changed).returncode == 0
    assert compare(whole, tmp_path / "none.log").returncode == 2


def test_a_walk_that_leaves_the_other_or_ends_early_is_found(tmp_path):
    whole = log_of(tmp_path / "whole.log", 3000, list(range(1100, 3000, 200)))
    other = log_of(tmp_path / "other.log", 3000, [1100, 1300] + list(range(1501, 3000, 200)))
    found = compare(whole, other)
    assert found.returncode == 1 and "tick 1500, frame 390" in found.stdout
    short = log_of(tmp_path / "short.log", 1400, [1100, 1300])
    assert compare(whole, short).returncode == 0
    found = compare(whole, short, "--steps", 3)
    assert found.returncode == 1 and "too short" in found.stdout
