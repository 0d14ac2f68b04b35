"""The walk over a real CAN stack is the walk on the in-process bus, tick by tick."""
import re
import subprocess

from afo import BUILD, ROOT


def test_twenty_steps_over_vcan_equal_the_in_process_walk():
    done = subprocess.run(["scripts/hil", "--steps", "20", "--build", str(BUILD)], cwd=ROOT,
                          capture_output=True, text=True, timeout=500)
    assert done.returncode == 0, done.stdout + done.stderr
    steps = re.search(r"equal: ticks 1000 to \d+, (\d+) steps", done.stdout)
    assert steps and int(steps[1]) >= 15


def test_a_changed_frame_is_found(tmp_path):
    line = "(0000000001.{:06d}) can0 {}\n"
    frames = []
    for tick in range(1300):
        for text in ("080#", "201#0100000002000000", "283#0102030405", "284#0102030405"):
            frames.append(line.format(len(frames), text))
        if tick % 250 == 249:
            frames.append(line.format(len(frames), "390#0000000000000000"))
    whole = tmp_path / "whole.log"
    whole.write_text("".join(frames))
    changed = tmp_path / "changed.log"
    at = 1200 * 4 + 4 + 1
    assert "201#" in frames[at]
    changed.write_text("".join(frames[:at]) + frames[at].replace("201#01", "201#03") +
                       "".join(frames[at + 1:]))

    def compare(*logs):
        return subprocess.run(["scripts/compare-walks", *map(str, logs)], cwd=ROOT,
                              capture_output=True, text=True, timeout=60)
    assert compare(whole, whole).returncode == 0
    found = compare(whole, changed)
    assert found.returncode == 1
    assert "frame 201" in found.stdout
    assert compare(whole, tmp_path / "none.log").returncode == 2
