"""What the controller knows of the apex speed in a long closed loop, against the plant's truth."""
import csv
import math

import pytest

from afo import run

SETTLED = 100


@pytest.mark.parametrize("sensors, count, rms, worst", [("14bit", 2000, 6e-4, 3e-3),
                                                        ("17bit", 500, 1e-4, 5e-4)])
def test_many_steps(sensors, count, rms, worst, tmp_path):
    """One count of noise RMS, 2 ms of latency. Asked for: 0.3 % RMS with 14 bit, 0.05 % with 17."""
    steps = tmp_path / "steps.csv"
    done = run("--speed", 0.8, "--steps", count, "--sensors", sensors, "--sensor-noise", 1,
               "--sensor-latency", 2, "--csv", steps, "--quiet")
    assert done.returncode == 0, done.stderr
    with open(steps, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["measured_speed_rad_s"]][SETTLED:]
    assert len(rows) >= count - SETTLED - 2
    true = [float(row["apex_speed_rad_s"]) for row in rows]
    off = [float(row["measured_speed_rad_s"]) / speed - 1.0 for row, speed in zip(rows, true)]
    assert math.sqrt(sum(e * e for e in off) / len(off)) < rms
    assert max(abs(e) for e in off) < worst
    assert abs(sum(true) / len(true) - 0.8) < 0.001
