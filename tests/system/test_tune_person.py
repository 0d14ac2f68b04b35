"""Persons who walk by reflexes: their tuning, their files, and their gait against that of people."""
import json
import re

import pytest

from afo import ROOT, run

ADULT = "sim_host/persons/adult70.ini"
SHORT = ("--person", ADULT, "--seconds", 5, "--walks", 1, "--step-ms", 0.5, "--seed", 3)


def tune(*words):
    return run("tune-person", *words, command="study")


def validate(person, *words):
    done = run("validate-person", "--person", person, "--json", *words, command="study")
    assert done.returncode in (0, 1), done.stderr
    return json.loads(done.stdout)


def test_a_tuning_goes_on_where_it_was_left(tmp_path):
    """In one go, in two, and in two threads: the same person."""
    whole = tune(*SHORT, "--generations", 3, "--out", tmp_path / "whole.ini")
    assert whole.returncode == 0, whole.stderr
    values = [float(v) for v in re.findall(r"([0-9.]+) in the mean", whole.stdout)]
    assert len(values) == 3 and all(0 < v <= 200 for v in values)
    for generations, out in ((1, "part.ini"), (3, "parts.ini")):
        part = tune(*SHORT, "--generations", generations, "--out", tmp_path / out, "--state", tmp_path / "s", "--jobs", 2)
        assert part.returncode == 0, part.stderr
    assert (tmp_path / "parts.ini").read_text() == (tmp_path / "whole.ini").read_text()
    assert (tmp_path / "part.ini").read_text() != (tmp_path / "whole.ini").read_text()
    assert re.search(r"^tuned_seed = 3 ", (tmp_path / "whole.ini").read_text(), re.M)
    assert re.search(r"^tuned_walks = 39 ", (tmp_path / "whole.ini").read_text(), re.M)
    other = tune(*SHORT, "--generations", 3, "--out", tmp_path / "no.ini", "--state", tmp_path / "s", "--sigma", 0.1)
    assert other.returncode == 1 and "is of another tuning or none" in other.stderr
    (tmp_path / "s").write_text("\n".join((tmp_path / "s").read_text().splitlines()[:20]))
    torn = tune(*SHORT, "--generations", 3, "--out", tmp_path / "no.ini", "--state", tmp_path / "s")
    assert torn.returncode == 1 and "is incomplete" in torn.stderr
    assert not (tmp_path / "no.ini").exists()


def test_what_is_asked_for_and_what_may_be_said_is_printed():
    objective = tune("--objective").stdout
    assert "speed" in objective and "step time" in objective and "knee, most in swing" in objective
    keys = tune("--keys").stdout
    gains = re.findall(r"X\((\w+),", (ROOT / "sim_host/reflex/reflexes.h").read_text())
    named = re.findall(r"^  (\w+)", keys, re.M)
    assert set(gains) - {"name"} <= set(named) and "noise" in named and "sol_strength" in named
    assert tune("--person", ADULT).returncode == 2


def test_a_wrong_muscle_is_refused_with_file_and_line(tmp_path):
    person = tmp_path / "who.ini"
    person.write_text((ROOT / ADULT).read_text() + "[muscles]\nnoise = 2\nsol_force = strong\n")
    line = len(person.read_text().splitlines())
    for done in (run("--plant", "reflex", "--person", person, "--device", "sim_host/devices/virtual-adult.ini", "--steps", 2),
                 run("validate-person", "--person", person, command="study")):
        assert done.returncode == 2
        assert f"{person}:{line}" in done.stderr and "sol_force" in done.stderr
