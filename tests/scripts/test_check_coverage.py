"""scripts/check-coverage: what it must refuse, and what it must let pass."""
import json
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

SOURCE = ["int probe(int a, int b)", "{", "    if (a > 0 || b > 0) {", "        return 1;", "    }", "    return 0;", "}"]


def line(number, count, branches=()):
    return {"line_number": number, "count": count, "gcovr/noncode": False,
            "branches": [{"count": branch} for branch in branches]}


REACHED = [line(1, 9), line(3, 9, [4, 5, 2, 3]), line(4, 6), line(6, 3)]
ONE_BRANCH_LESS = [line(1, 9), line(3, 9, [4, 5, 0, 5]), line(4, 4), line(6, 5)]
ONE_LINE_LESS = [line(1, 9), line(3, 9, [0, 9, 0, 9]), line(4, 0), line(6, 9)]
EXCUSE = "hal/probe.c | a > 0 || b > 0 | 0 1 | b is never above 0 while a is below"


def judge(tmp_path, lines, excuses="", file="hal/probe.c"):
    (tmp_path / "scripts").mkdir()
    (tmp_path / "scripts" / "coverage-exclusions.txt").write_text(excuses + "\n")
    (tmp_path / file).parent.mkdir(parents=True)
    (tmp_path / file).write_text("\n".join(SOURCE) + "\n")
    report = tmp_path / "report.json"
    report.write_text(json.dumps({"files": [{"file": file, "lines": lines}]}))
    done = subprocess.run([ROOT / "scripts" / "check-coverage", report, tmp_path], capture_output=True, text=True,
                          timeout=60)
    return done.returncode, done.stdout + done.stderr


@pytest.mark.parametrize("lines,excuses,status,word", [
    (REACHED, "", 0, "lines 4 of 4 (100.00 %), branches 4 of 4"),
    (ONE_BRANCH_LESS, "", 1, "hal/probe.c:3: no test reaches: 1 of 4 branches"),
    (ONE_LINE_LESS, EXCUSE, 1, "hal/probe.c:4: no test reaches: line: return 1;"),
    (ONE_BRANCH_LESS, EXCUSE, 0, "excused, with a reason: 0 lines, 1 branches; open, not tested yet: 0 lines, 0"),
    # What is reached after all has to leave the list.
    (REACHED, EXCUSE, 1, "says 0 lines and 1 branches are not reached; 0 and 0 are not"),
    # One excuse does not cover a second branch beside it.
    (ONE_LINE_LESS[:2] + [line(4, 1), line(6, 9)], EXCUSE, 1, "0 and 2 are not"),
    (REACHED, EXCUSE.replace("b > 0", "c > 0"), 1, "no such line"),
    (ONE_BRANCH_LESS, EXCUSE.split("|")[0] + "| a > 0 | 0 1 | because", 1, "in words"),
    (ONE_BRANCH_LESS, EXCUSE.replace("| b is", "| OPEN: b is"), 0, "open, not tested yet: 0 lines, 1 branches"),
])
def test_verdict(tmp_path, lines, excuses, status, word):
    returncode, said = judge(tmp_path, lines, excuses)
    assert returncode == status and word in said, said


def test_rooms_that_are_not_held(tmp_path):
    returncode, said = judge(tmp_path, ONE_LINE_LESS, "", "hal/port_mps2/probe.c")
    assert returncode == 1 and "no test reaches" not in said  # nothing measured is no success
