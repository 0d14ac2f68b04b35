"""scripts/plot-walk draws its pictures from CSV files, marks the events where they are, and
leaves no half-written picture."""
import csv
import importlib.machinery
import importlib.util
import math
import pathlib
import subprocess

import pytest

from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "plot-walk"
PICTURES = ["phase-portrait.png", "speed-and-r0.png", "stick-figure.png"]

# A made-up walk: 100 ms of both feet down, 500 ms of one foot, legs by turns.
DOUBLE, SINGLE = 20, 100
TICK_S = 0.005


def write(path, header, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([header, *rows])


def tick_rows(steps):
    rows, tick = [], 0
    for step in range(steps):
        # The trailing leg keeps the name of stance leg until it lifts off.
        trailing, leading = ("left", "right") if step % 2 else ("right", "left")
        for i in range(DOUBLE + SINGLE):
            double = i < DOUBLE
            angle = 0.3 * math.cos(math.pi * i / (DOUBLE + SINGLE))
            angles = {leading: angle, trailing: -angle}
            rows.append([tick, tick * TICK_S, trailing if double else leading, "double" if double else "single",
                         angles["left"], angles["right"], -0.4, 0.5, 0, 0, 0, 0, -0.002 * tick,
                         math.cos(angle), ""])
            tick += 1
    return rows


@pytest.fixture
def walk(tmp_path):
    step_header = ["step", "time_s", "side", "apex_speed_rad_s", "measured_speed_rad_s", "target_speed_rad_s",
                   "r0_m", "step_time_s", "step_length_m"]
    tick_header = ["tick", "time_s", "stance", "phase", "theta_left_rad", "theta_right_rad", "rate_left_rad_s",
                   "rate_right_rad_s", "ankle_left_m", "ankle_right_m", "motor_left_m", "motor_right_m", "hip_x_m",
                   "hip_y_m", "event"]
    write(tmp_path / "law.csv", step_header,
          [[i, i, "left", 0.4 + 0.01 * i, 0.4, 0.8, 0.05, 0.9, 0.5] for i in range(1, 41)])
    write(tmp_path / "held.csv", step_header,
          [[i, i, "left", 0.4 + 0.05 * (i % 2), 0.4, 0.8, 0.05, 0.9, 0.5] for i in range(1, 21)])
    write(tmp_path / "ticks.csv", tick_header, tick_rows(7))
    return tmp_path


def plot(folder, **changed):
    files = {"law": "law.csv", "held": "held.csv", "ticks": "ticks.csv", **changed}
    arguments = [word for name, file in files.items() for word in (f"--{name}", folder / file)]
    return subprocess.run(["/usr/bin/python3", SCRIPT, *arguments, "--out", folder / "out"], capture_output=True,
                          text=True, timeout=120)


def test_three_pictures_with_something_on_them(walk):
    done = plot(walk)
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in (walk / "out").iterdir()) == PICTURES
    for name in PICTURES:
        with Image.open(walk / "out" / name) as picture:
            assert picture.width > 600 and picture.height > 300
            colours = picture.convert("RGB").getcolors(1 << 24)
            assert len(colours) > 50  # lines, text, markers: not a blank page


def test_events_are_where_the_walk_has_them(walk):
    loader = importlib.machinery.SourceFileLoader("plot_walk", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("plot_walk", loader))
    loader.exec_module(module)
    ticks = module.read_columns(walk / "ticks.csv")
    first, lift_off, strike, other_lift_off, end = module.last_cycle(ticks)
    step = DOUBLE + SINGLE
    assert (lift_off - first, strike - first, other_lift_off - first, end - first) == (
        DOUBLE, step, step + DOUBLE, 2 * step)
    assert ticks["stance"][first - 1] == "left"  # leg A is the one that pushes off at 1
    assert ticks["stance"][strike - 1] == "right"


def test_bad_input_is_an_error_and_leaves_no_picture(walk):
    (walk / "empty.csv").write_text("step,apex_speed_rad_s\n")
    done = plot(walk, law="empty.csv")
    assert done.returncode != 0 and "empty.csv" in done.stderr
    assert list((walk / "out").iterdir()) == []
