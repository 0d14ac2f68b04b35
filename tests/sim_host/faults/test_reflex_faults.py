"""The campaign of a person who walks by reflexes: a sample, and whose a fall was.

The whole is `make faults-reflex`. What is unsafe is the judge's of the campaign of people.
"""
import os
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
BUILD = pathlib.Path(os.environ.get("AFO_BUILD", ROOT / "build")).resolve()
PERSON_FALLS = 95  # a run of seed 1 whose only fault is that


def reflex(*arguments):
    return subprocess.run([BUILD / "afo", "faults", "--plant", "reflex", *map(str, arguments)], cwd=ROOT,
                          capture_output=True, text=True)


def falls(text):
    """Whose fall it was -> how many runs."""
    return {name: int(runs) for name, runs in
            re.findall(r"^(none|the person's own|the device's|the fault's) +(\d+) +\d+$", text, re.MULTILINE)}


def unsafe(text):
    return [line for line in text.splitlines() if line.startswith("run ") and ("UNSAFE" in line or "LATE" in line)]


def test_a_sample_is_safe_and_every_fall_has_an_owner(tmp_path):
    result = reflex("--runs", 8, "--jobs", 2, "--out", tmp_path)
    assert result.returncode == 0, result.stderr
    assert unsafe(result.stdout) == []
    assert sum(falls(result.stdout).values()) == 8
    lines = [line.split() for path in tmp_path.iterdir() for line in path.read_text().splitlines()]
    assert sorted(int(line[0]) for line in lines) == list(range(8))
    assert sum(int(line[1]) for line in lines) >= 6  # assisted
    again = reflex("--runs", 8, "--out", tmp_path)
    assert again.stdout == result.stdout


def test_who_is_knocked_down_falls_without_the_device_too():
    told = reflex("--run", PERSON_FALLS).stdout
    assert "person falls" in told and "fell: the person's own" in told and "UNSAFE" not in told


@pytest.mark.long
def test_a_larger_sample_is_safe():
    result = reflex("--runs", 204, "--jobs", 2)
    assert result.returncode in (0, 1), result.stderr
    assert unsafe(result.stdout) == [] and falls(result.stdout)["the person's own"] >= 2


@pytest.mark.parametrize("arguments, words", [
    (("--people",), "choose one"), (("--run", 94), "cannot be told"), (("--data", "x"), "--data needs --people"),
    (("--person", "sim_host/persons/adult70.ini", "--out", "x"), "leave out"), (("--person", "nobody.ini"), "nobody.ini")])
def test_wrong_usage(arguments, words):
    result = reflex(*arguments)
    assert result.returncode == 2 and words in result.stderr
