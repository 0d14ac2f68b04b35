"""afo soak for a minute of walking: all well; and what is made ill in it is noticed, by name.
The hundred million ticks of `make soak` take a quarter of an hour of processor time."""
import os
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("AFO_BUILD", ROOT / "build")).resolve()
TICKS = 60000  # passes the ends of clocks and counters, which begin 20,000 before them


def soak(*arguments):
    done = subprocess.run([BUILD / "afo", "soak", "--ticks", str(TICKS), *arguments], capture_output=True, text=True)
    return done.returncode, re.findall(r"^ILL : (.*)$", done.stdout, re.M), done.stdout + done.stderr


def test_a_minute_is_well():
    status, ill, said = soak()
    assert status == 0 and ill == [], said
    assert said.count("well: ") == 6 and "60000 ticks" in said


@pytest.mark.parametrize("what,noticed", [
    ("leak", ["not a byte more of the heap"]),
    ("wrap", ["no counter went back"]),
    ("stuck", ["no counter went back", "SYNCs are counted"]),
    ("clock", ["the controller's tick and time"]),
    ("stop", ["it walks in every part"]),
])
def test_what_is_made_ill_is_noticed(what, noticed):
    status, ill, said = soak("--inject", what)
    assert status == 1, said
    assert len(ill) == len(noticed) and all(a.startswith(b) for a, b in zip(ill, noticed)), said


def test_what_is_too_short_to_judge_is_refused():
    done = subprocess.run([BUILD / "afo", "soak", "--ticks", "1000"], capture_output=True, text=True)
    assert done.returncode == 2 and "60000" in done.stderr and "ILL" not in done.stdout


def test_usage():
    assert soak("--inject", "nothing at all")[0] == 2
