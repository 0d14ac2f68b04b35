"""The judge of people's walks: it must see each kind of wrong push, and say nothing of a right one."""
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "system"))

from made_gait import made_gait  # noqa: E402


def load():
    loader = importlib.machinery.SourceFileLoader("score_people", str(ROOT / "scripts" / "score-people"))
    spec = importlib.util.spec_from_loader("score_people", loader)
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def judge():
    return load()


@pytest.fixture(scope="module")
def rows():
    return made_gait(20.0)


def result(judge, rows, releases, rights=()):
    """What a detector without any error would report, with these releases of the left latch."""
    copies = judge.copies
    return {side: {"apex_s": [], "heel_strike_s": copies.edges(rows, leg, 1), "toe_off_s": copies.edges(rows, leg, 0),
                   "release_s": releases if side == "left" else rights}
            for side, leg in judge.SIDES.items()}


def scored(judge, rows, releases, walks=True, stands_s=None, rights=()):
    copy = judge.copies.Copy(rows, walks, stands_s)
    return judge.judge("made", copy, result(judge, rows, releases, list(rights)))


def test_a_push_behind_the_other_strike_is_right(judge, rows):
    strikes, others = (judge.copies.edges(rows, leg, 1) for leg in ("r", "l"))
    score = scored(judge, rows, [t + 0.01 for t in strikes[4:]], rights=[t + 0.01 for t in others[4:]])
    assert score["unsafe"] == 0
    assert score["pushes"]["late"] == 0
    assert score["pushes"]["given"] == score["pushes"]["stances"] > 20
    assert score["heel_strike"]["left"]["missed"] == score["heel_strike"]["left"]["false"] == 0


@pytest.mark.parametrize("off_s, kind", [(-0.025, "early"), (0.07, "late"), (0.25, "air")])
def test_each_wrong_time_is_seen(judge, rows, off_s, kind):
    strikes = judge.copies.edges(rows, "r", 1)[4:]
    score = scored(judge, rows, [t + off_s for t in strikes])
    assert score["pushes"][kind] == len(strikes)
    assert (score["unsafe"] > 0) == (kind != "late")


def test_pushes_that_must_not_be_are_seen(judge, rows):
    release = [judge.copies.edges(rows, "r", 1)[6] + 0.005]
    assert scored(judge, rows, release, walks=False)["unsafe"] == 1
    assert scored(judge, rows, release, stands_s=release[0] - 0.1)["unsafe"] == 1


def test_missed_and_false_strikes_are_counted(judge, rows):
    found = result(judge, rows, [])
    found["left"]["heel_strike_s"] = [t + 0.012 for t in found["left"]["heel_strike_s"] if t < 10] + [12.1234]
    score = judge.judge("made", judge.copies.Copy(rows, True, None), found)["heel_strike"]["left"]
    assert score["missed"] > 5
    assert score["false"] + sum(abs(e) > 0.02 for e in score["errors"]) == 1
    assert min(abs(e - 0.012) for e in score["errors"]) < 1e-9


def test_every_copy_is_a_recording(judge, rows):
    copies = judge.copies
    for name, make in {**copies.COPIES, **copies.MADE}.items():
        copy = make(rows)
        times = [row["time_s"] for row in copy.rows]
        assert all(b > a for a, b in zip(times, times[1:])), name
        assert all(row[f"contact_{leg}"] in (0, 1) for row in copy.rows for leg in copies.LEGS), name
        assert copy.rows != rows, name


def test_who_is_left_out_does_not_choose_the_constant(judge):
    """Three people with a bias each: the others' means are known by hand."""
    errors = {"a": [0.009, 0.012, 0.006], "b": [0.020] * 4, "c": [0.060, 0.060]}
    rows = {row[0]: row[1:] for row in judge.leave_one_out(errors)}
    count, constant, limit, in_16, in_30, in_limit = rows["c"]
    assert (count, in_16, in_30, in_limit) == (2, 0.0, 0.0, 0.0)
    assert constant == pytest.approx(0.0145)      # the mean of 9 and 20 ms
    assert limit == pytest.approx(0.0085)         # 6 ms is furthest from it
    count, constant, _, in_16, in_30, _ = rows["a"]
    assert constant == pytest.approx(0.040)
    assert (in_16, in_30) == (0.0, pytest.approx(1 / 3))  # 28, 31 and 34 ms off


def test_a_child_s_recordings_are_one_person_s(judge):
    assert judge.person_of("child_a_loop_3/plain") == judge.person_of("child_a_1/plain") != judge.person_of("gait_young/plain")


def test_help_and_wrong_use():
    script = ROOT / "scripts" / "score-people"
    done = subprocess.run([script, "--help"], capture_output=True, text=True, check=True)
    assert "in the air" in done.stdout
    done = subprocess.run([script, "--copy", "flying"], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "flying" in done.stderr
