"""The campaign of people as a program: a sample of it, with made people everywhere and recorded ones where they are.

Run i is the same run on every machine with the same recordings. The whole is `make faults-people`; which of its
runs are unsafe, and what forces them, stands in controller/SAFETY.md.
"""
import json
import os
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
BUILD = pathlib.Path(os.environ.get("AFO_BUILD", ROOT / "build")).resolve()
MADE = {name: value for name, value in os.environ.items() if name != "AFO_DATA"}

# What physics forces, by the name of a fault or of a criterion; SAFETY.md says why.
FORCED = re.compile(r"drive hangs|motor jammed|drive force limited|drive speed limited|drive without force|share of its|"
                    r"low battery|motor encoder|spring stiffer|controller resets|controller misses|latch opens by itself|"
                    r"foreign node sends commands|leg-held")
# What the controller could know, and does not yet: SAFETY.md counts it apart.
OPEN = re.compile(r"motor's scale|parameter changes in memory")


def people(*arguments, env=None):
    return subprocess.run([BUILD / "afo", "faults", "--people", *map(str, arguments)], cwd=ROOT, capture_output=True,
                          text=True, env=env)


def rows(text):
    """The table: name -> (runs, assisted, pushes, noticed, late, unsafe, latched)."""
    found = re.finditer(r"^(\S.*?) {2,}" + r" +".join([r"(\d+)"] * 7) + "$", text, re.MULTILINE)
    return {match[1]: tuple(int(match[i]) for i in range(2, 9)) for match in found}


def told(text):
    return [line for line in text.splitlines() if line.startswith("run ")]


def unforced(text):
    return [line for line in told(text) if ("UNSAFE" in line or "LATE" in line) and not FORCED.search(line) and not OPEN.search(line)]


def test_a_sample_with_made_people_is_safe():
    result = people("--runs", 306, "--jobs", 2, env=MADE)
    assert result.returncode in (0, 1), result.stderr
    runs, assisted, pushes, noticed, _, _, _ = rows(result.stdout)["all runs"]
    assert runs == 306
    assert assisted > 0.7 * runs and pushes > 2 * runs and noticed > 100
    assert unforced(result.stdout) == []


def test_people_without_a_fault_are_walked_and_pushed():
    result = people("--runs", 1224, "--only", "no fault", "--jobs", 2, env=MADE)
    assert result.returncode == 0, result.stdout
    runs, assisted, pushes, *_ = rows(result.stdout)["no fault"]
    assert runs == 12 and assisted >= 8 and pushes > 80


@pytest.mark.data
def test_a_sample_with_recorded_people_is_safe():
    result = people("--runs", 204, "--jobs", 2)
    assert result.returncode in (0, 1), result.stderr
    assert unforced(result.stdout) == []


def test_safety_accounts_for_every_unsafe_run():
    """SAFETY.md says how many runs of the last campaign were unsafe; its causes add up to them."""
    text = (ROOT / "controller/SAFETY.md").read_text()
    text = text[text.index("## The campaign of people"):]
    said = re.search(r"([\d,]+) runs of people[^|]*?(\d+) unsafe, (\d+) of them\s+single faults and (\d+) pairs", text)
    whole, unsafe, single, pairs = (int(number.replace(",", "")) for number in said.groups())
    assert whole >= 10000 and unsafe == single + pairs
    causes = text[text.index("| cause | single | pairs |"):].split("\n\n")[0].splitlines()[2:]
    cells = [[cell.strip() for cell in row.strip().strip("|").split("|")] for row in causes]
    assert len(cells) > 5
    assert sum(int(row[1]) for row in cells) == single
    assert sum(int(row[2]) for row in cells) == pairs


def test_a_run_repeats_byte_for_byte(tmp_path):
    one = people("--run", 7, "--log", tmp_path / "a.log", "--csv", tmp_path / "a.csv", env=MADE)
    two = people("--run", 7, "--log", tmp_path / "b.log", "--csv", tmp_path / "b.csv", env=MADE)
    assert one.stdout == two.stdout != ""
    assert (tmp_path / "a.log").read_bytes() == (tmp_path / "b.log").read_bytes() != b""
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    assert people("--run", 7, "--seed", 2, env=MADE).stdout != one.stdout


def test_a_table_says_what_it_is_a_table_of(tmp_path):
    table = tmp_path / "a.csv"
    told = people("--run", 107, "--csv", table, env=MADE).stdout
    said = json.loads((tmp_path / "a.csv.json").read_text())
    assert said["run"] == 107 and said["seed"] == 1 and said["recordings"] == 0
    assert f"({said['who']}; " in told and f"switches {said['switches']})" in told
    assert (ROOT / said["device"]).is_file()
    assert said["from_power_on"] == ("from power-on" in told)
    assert said["faults"] and all(fault["name"] in told for fault in said["faults"])


def test_a_run_alone_is_the_run_of_the_campaign(tmp_path):
    """A scene that is walked for one run, or for sixteen, is the same."""
    people("--runs", 20, "--out", tmp_path, env=MADE)
    line = next(line for line in (tmp_path / "people0-seed1-job0.txt").read_text().splitlines()
                if line.startswith("17 "))
    alone = people("--run", 17, env=MADE).stdout
    noticed = int(line.split()[3])
    assert (f"noticed at {noticed}," in alone) == (noticed < 2 ** 32 - 1)
    assert f" {line.split()[6]} pushes" in alone


def test_an_interrupted_campaign_goes_on(tmp_path):
    whole = people("--runs", 20, "--out", tmp_path / "whole", env=MADE)
    part = people("--runs", 9, "--jobs", 2, "--out", tmp_path / "part", env=MADE)
    assert whole.returncode in (0, 1) and part.returncode in (0, 1)
    kept = {path.name: path.read_text() for path in (tmp_path / "part").iterdir()}
    rest = people("--runs", 20, "--out", tmp_path / "part", env=MADE)
    assert rest.stdout == whole.stdout
    for name, text in kept.items():
        assert (tmp_path / "part" / name).read_text().startswith(text)


@pytest.mark.parametrize("arguments", [("--data", "/nowhere/at/all"), ("--runs", 3, "--only", "nonsense"), ("more",)])
def test_wrong_usage(arguments):
    result = people(*arguments)
    assert result.returncode == 2
    assert result.stderr


def test_elsewhere_it_says_where_to_call_it(tmp_path):
    done = subprocess.run([BUILD / "afo", "faults", "--people", "--runs", "1"], cwd=tmp_path, capture_output=True,
                          text=True)
    assert done.returncode == 2
    assert "top of the source tree" in done.stderr
