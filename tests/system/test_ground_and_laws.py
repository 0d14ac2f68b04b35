"""afo sim's --law, --slope-deg, --terrain-mm and --push: what eq. (16) falls over, the predictive law takes."""
import csv
import json
import os
import pathlib
import subprocess

import pytest

from afo import converted, file_of, with_lines

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / os.environ.get("BUILD", "build") / "afo"


def walk(*arguments, status=None):
    run = subprocess.run([PROGRAM, "sim", "--quiet", "--json", *map(str, arguments)], capture_output=True,
                         text=True, check=False, timeout=300)
    if status is not None:
        assert run.returncode == status, run.stderr
        return run
    return json.loads(run.stdout)


# start gait at 0.8 rad/s
FAST = ("--start-r0", 0.1724, "--speed", 0.8)


@pytest.mark.parametrize("what", [("--slope-deg", 1), ("--slope-deg", -1), ("--push", "0.05@6"),
                                  ("--push", "-0.05@6"), ("--terrain-mm", 4)])
def test_predictive_walks_where_equation_16_falls(what):
    assert walk(*FAST, "--steps", 60, "--law", "proportional", *what)["fell"]
    held = walk(*FAST, "--steps", 60, "--law", "predictive", *what)
    assert not held["fell"], held["fault"]
    if what[0] != "--terrain-mm":
        assert held["apex_speed_rad_s"][-1] == pytest.approx(0.8, rel=0.02)


def test_a_jump_of_the_command_through_the_chain():
    up = walk("--law", "predictive", "--speed", 0.8, "--steps", 60, "--sensors", "14bit")
    assert not up["fell"]
    assert all(abs(v - 0.8) < 0.008 for v in up["apex_speed_rad_s"][40:])


def test_nobody_gets_faster_than_asked_unless_it_is_prescribed(tmp_path):
    """A push on level ground: at 0.4 rad/s it takes the walk itself to about 0.48. Told by the command column, too."""
    person = tmp_path / "person.ini"
    fastest, aimed = {}, {}
    for allowed in (0, 0.8):
        with_lines(person, file_of("persons", "paper"), ["law = predictive", f"terrain_speed_rad_s = {allowed}"],
                   "prescription")
        table = tmp_path / "walk.csv"
        fastest[allowed] = max(walk("--person", person, "--speed", 0.4, "--push", "0.05@20", "--steps", 50,
                                    "--csv", table)["apex_speed_rad_s"][10:])
        with table.open(encoding="utf-8", newline="") as file:
            aimed[allowed] = [float(row["target_speed_rad_s"]) for row in list(csv.DictReader(file))[10:]]
    assert fastest[0] < 0.5 and aimed[0] == pytest.approx([0.4] * len(aimed[0]), abs=1e-4)
    assert fastest[0.8] > 0.6 and max(aimed[0.8]) > 0.6


def test_the_laws_can_be_prescribed(tmp_path):
    person = with_lines(tmp_path / "person.ini", file_of("persons", "paper"), ["law = predictive"], "prescription")
    options = ("--speed", 0.5, "--steps", 20)
    by_file = walk("--person", person, *options)["r0_m"]
    assert by_file == pytest.approx(walk("--law", "predictive", *options)["r0_m"], abs=1e-5)
    assert by_file != pytest.approx(walk(*options)["r0_m"], abs=1e-3)
    with_lines(person, file_of("persons", "paper"), ["law = magic"], "prescription")
    assert "law" in walk("--person", person, status=2).stderr


# M, m, l, k: light and heavy legs, an adult, a child, soft and stiff ankles
WALKERS = {"light legs": (1, 0.005, 1, 100), "m/M = 0.1": (1, 0.1, 1, 100), "m/M = 0.2": (1, 0.2, 1, 100),
            "adult": (65, 2.5, 0.93, 7000), "adult, heavy legs": (65, 13, 0.93, 7000),
            "child": (22, 1.0, 0.55, 3500), "tall": (110, 5, 1.05, 9000), "stiff": (1, 0.05, 1, 200)}


@pytest.mark.parametrize("name", WALKERS)
def test_equation_16_has_a_gain_that_holds_this_walker(name, tmp_path):
    mass, leg, length, stiffness = WALKERS[name]
    walker = converted(tmp_path, f"[walker]\nM = {mass}\nm = {leg}\nl = {length}\nk = {stiffness}\ng = 9.80665\n")
    for share in (0.4, 0.6, 0.75):  # of the paper's walker's speed
        speed = round(share * length ** -0.5, 4)
        held = walk(*walker, "--speed", speed, "--steps", 200, "--sensors", "ideal")
        assert not held["fell"], (share, held["fault"])
        assert held["apex_speed_rad_s"][-1] == pytest.approx(speed, rel=0.003)


def test_a_speed_without_push_off_in_reserve_is_refused():
    assert "out of range" in walk("--speed", 1.16, "--steps", 5, status=2).stderr
    fastest = walk("--speed", 1.14, "--steps", 250, "--sensors", "ideal")
    assert not fastest["fell"]
    assert fastest["apex_speed_rad_s"][-1] == pytest.approx(1.14, rel=0.001)


@pytest.mark.parametrize("arguments", [
    ("--law", "magic"), ("--law", "open-loop"), ("--slope-deg", 45), ("--terrain-mm", -1),
    ("--push", "0.1"), ("--push", "x@1"), ("--push", "0.1@-2"), ("--law", "dlqr", "--open-loop", "--r0", 0.05)])
def test_bad_values_are_usage_errors(arguments):
    assert walk(*arguments, status=2).stderr
