"""A walk of a person played to the controller: one apex per stance, none missed, none false.

Played are a made walk and, where AFO_DATA names a folder with it, a recorded one (conftest.py).
"""
import csv
import math
import subprocess

import pytest

from afo import ROOT, recording, run, walk


def read_rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def stances_with_apex(rows, side):
    """How often the virtual leg falls through the vertical while its foot is down."""
    count, previous = 0, None
    for row in rows:
        thigh, shank = (math.radians(row[f"{part}_{side}_deg"]) for part in ("thigh", "shank"))
        pitch = math.atan2(math.sin(thigh) + math.sin(shank), math.cos(thigh) + math.cos(shank))
        if previous is not None and previous > 0 >= pitch and row[f"contact_{side}"] == 1:
            count += 1
        previous = pitch
    return count


@pytest.fixture(scope="module")
def person_walk(person):
    return walk("--recording", person)


def test_one_apex_per_stance(person_walk, person):
    _, result = person_walk
    rows = read_rows(person)
    assert result["apexes_left"] == stances_with_apex(rows, "l") > 40
    assert result["apexes_right"] == stances_with_apex(rows, "r") > 40


@pytest.mark.data
def test_the_apexes_of_the_recording():
    _, result = walk("--recording", recording())
    assert (result["apexes_left"], result["apexes_right"]) == (45, 44)


def test_r0_is_reported_for_every_step(person_walk):
    _, result = person_walk
    assert len(result["r0_m"]) > 0
    assert all(math.isfinite(r0) and 0 <= r0 < 0.3 for r0 in result["r0_m"])


def test_a_recording_that_is_none_is_refused(tmp_path):
    for name, text in (("empty.csv", ""), ("other.csv", "a,b\n1,2\n"),
                       ("short.csv", "time_s,thigh_l_deg\n0,1\n0.005,x\n")):
        (tmp_path / name).write_text(text)
        done = run("--recording", tmp_path / name, "--json")
        assert done.returncode == 2
        assert name in done.stderr
        assert done.stdout == ""


@pytest.mark.data
def test_nothing_of_the_recording_is_in_the_tree():
    line = recording().read_text(encoding="utf-8").splitlines()[1000]
    found = subprocess.run(["git", "grep", "-lF", line], cwd=ROOT,
                           capture_output=True, text=True)
    assert found.stdout == ""
