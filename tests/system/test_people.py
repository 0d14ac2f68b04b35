"""People, and changed copies of them, under the judge that knows the truth: scripts/score-people.

The judge reads the recorded contacts and what `afo sim --recording` reports, nothing else. The pushes are
with foot switches that are simulated from truth, late by a bias that the device does not know; detection
is judged with the switches unplugged. Played are made people everywhere, and the recorded ones where
AFO_DATA names a folder with them.
"""
import concurrent.futures
import importlib.machinery
import importlib.util
import json
import os
import pathlib

import pytest

from afo import AFO, ROOT, data, run
from made_gait import made_gait

LOADER = importlib.machinery.SourceFileLoader("score_people", str(ROOT / "scripts" / "score-people"))
judge = importlib.util.module_from_spec(importlib.util.spec_from_loader("score_people", LOADER))
LOADER.exec_module(judge)
copies = judge.copies

ADULTS = ["gait_young.csv", "people/gait_middle.csv"]
LOOPS = [f"people/child_a_loop_{n}.csv" for n in (1, 2, 3, 4)]
OTHERS = ["people/child_a_1.csv", "people/child_a_2.csv", "people/child_a_3.csv", "people/plates_a.csv",
          "people/plates_b.csv"]
# Made people: stride time (s), size of the steps, asymmetry; each at 0.6 m/s or more on level ground.
MADE = {"usual": (1.12, 1.0, 0.0), "slow": (1.5, 0.8, 0.0), "brisk": (0.95, 1.1, 0.0), "limping": (1.2, 0.9, 0.04)}
FEW = ["limp", "trip", "stop-3", "stop-7", "offset", "quick"]
STRANGE = ["backwards", "harness", "leg-held", *copies.MADE]


def play(jobs, tmp_path):
    """Scores of (name, copy, options), some at the same time."""
    def one(job):
        name, copy, options = job
        folder = tmp_path / name.replace("/", "-").replace(" ", "-")
        folder.mkdir()
        return judge.play(AFO, name, copy, options, folder)
    with concurrent.futures.ThreadPoolExecutor(max(1, (os.cpu_count() or 2) - 1)) as pool:
        return list(pool.map(one, jobs))


def plain(rows, walks=True):
    return copies.Copy(rows, walks, None)


def made(name):
    stride_s, size, asymmetry = MADE[name]
    return made_gait(30.0, 3, stride_s, size, asymmetry)


def all_copies(name, rows, kinds=tuple(copies.COPIES), options=()):
    jobs = [(f"{name} plain", plain(rows), options)]
    for kind in kinds:
        copy = copies.COPIES[kind](rows)
        if copy is not None:
            jobs.append((f"{name} {kind}", copy, options))
    return jobs


def assert_safe(scores):
    for score in scores:
        assert "error" not in score, score
        assert score["unsafe"] == 0, judge.line(score)
        assert score["pushes"]["energy"] is None or score["pushes"]["energy"] <= 1.1, judge.line(score)


def assert_available(score):
    pushes = score["pushes"]
    assert pushes["given"] >= 0.95 * pushes["stances"] > 15, judge.line(score)
    assert pushes["first"] <= 10, judge.line(score)


@pytest.mark.parametrize("name", MADE)
def test_no_push_of_a_made_person_is_wrong(name, tmp_path):
    scores = play(all_copies(name, made(name), copies.COPIES if name == "usual" else FEW), tmp_path)
    assert_safe(scores)
    assert_available(scores[0])


@pytest.mark.parametrize("seed", [2, 3, 4, 5, 6])
def test_whatever_the_switches_biases(seed, tmp_path):
    score, = play([("usual", plain(made("usual")), ["--seed", str(seed)])], tmp_path)
    assert_safe([score])
    assert_available(score)


def test_what_is_not_walking_gets_no_push(tmp_path):
    rows = made("usual")
    jobs = [(kind, {**copies.COPIES, **copies.MADE}[kind](rows), []) for kind in STRANGE]
    for score in play(jobs, tmp_path):
        assert_safe([score])
        if score["name"] != "leg-held":  # there they walk before
            assert score["pushes"]["releases"] == 0, judge.line(score)


@pytest.mark.parametrize("fault", ["stuck-up", "stuck-down", "missing", "chatter", "false"])
def test_a_switch_s_fault_makes_no_wrong_push(fault, tmp_path):
    """A false contact within the window's lead may make one early, by at most 30 ms."""
    score, = play([("usual", plain(made("usual")), ["--switch-fault", fault])], tmp_path)
    pushes = score["pushes"]
    assert pushes["air"] == pushes["still"] == 0
    assert min(pushes["lead_ms"]) >= -30
    assert fault == "false" or pushes["early"] == 0
    assert 5 < pushes["releases"] < 30


@pytest.mark.parametrize("fault, pushes_after", [("opens", 2), ("stays-open", 2), ("stays-closed", 0)])
def test_a_latch_s_fault_ends_the_assistance(fault, pushes_after, tmp_path):
    """That of a latch which opens by itself comes before anybody can notice; none comes after."""
    rows = made("usual")
    score, = play([("usual", plain(rows), ["--latch-fault", fault, "--latch-fault-s", "15.0"])], tmp_path)
    done = run("--recording", copies.write(tmp_path / "usual.csv", rows), "--json", "--quiet", "--latch-fault", fault,
               "--latch-fault-s", "15.0")
    result = json.loads(done.stdout)
    after = [t for side in judge.SIDES for t in result[side]["release_s"] if t >= 15.0]
    assert len(after) <= pushes_after
    assert score["pushes"]["air"] == 0
    assert fault == "stays-closed" or "spring" in result["fault"]


def test_without_switches_assistance_is_refused(tmp_path):
    score, = play([("usual", plain(made("usual")), ["--switches", "none"])], tmp_path)
    assert score["pushes"]["releases"] == 0
    assert score["heel_strike"]["left"]["missed"] == 0


def fitted(path, tmp_path):
    """Detection without switches, after a fitting run with switches without a bias."""
    rows = copies.read(path)
    fit = tmp_path / "fit.ini"
    done = run("--recording", path, "--switches", "exact", "--fit", fit, "--quiet")
    assert done.returncode == 0, done.stderr
    score, = play([("fitted", plain(rows), ["--switches", "none", "--person", str(fit)])], tmp_path)
    return score


def errors(score, event):
    return [e for side in judge.SIDES for e in score[event][side]["errors"]], \
        sum(score[event][side]["missed"] + score[event][side]["false"] for side in judge.SIDES)


def share(values, limit_s):
    return sum(abs(v) <= limit_s for v in values) / len(values)


def test_a_fitting_run_takes_out_each_leg_s_bias(tmp_path):
    path = copies.write(tmp_path / "made.csv", made("limping"))
    before, = play([("before", plain(copies.read(path)), ["--switches", "none"])], tmp_path)
    after = fitted(path, tmp_path)
    for side in judge.SIDES:
        bias = judge.mean(after["heel_strike"][side]["errors"])
        assert abs(bias) < 0.004
        assert abs(bias) <= abs(judge.mean(before["heel_strike"][side]["errors"])) + 0.002


def test_a_fit_needs_switches_and_steps(tmp_path):
    path = copies.write(tmp_path / "made.csv", made_gait(5.0))
    assert run("--recording", path, "--switches", "none", "--fit", tmp_path / "fit.ini").returncode == 2
    done = run("--recording", path, "--fit", tmp_path / "fit.ini", "--quiet")
    assert done.returncode == 2
    assert "edges" in done.stderr
    assert not (tmp_path / "fit.ini").exists()


# ---- recorded people ------------------------------------------------------------------------

@pytest.mark.data
@pytest.mark.parametrize("name", [*ADULTS, LOOPS[0]])
def test_no_push_of_a_recorded_person_is_wrong(name, tmp_path):
    rows = copies.read(data(name))[:5000]
    scores = play(all_copies(name, rows, copies.COPIES if name in ADULTS else FEW), tmp_path)
    assert_safe([score for score in scores if "stop-0" not in score["name"]])


@pytest.mark.data
@pytest.mark.parametrize("name", OTHERS + LOOPS[1:])
def test_no_push_of_a_short_recording_is_wrong(name, tmp_path):
    assert_safe(play([(name, plain(copies.read(data(name))), [])], tmp_path))


@pytest.mark.data
def test_running_gets_no_push(tmp_path):
    rows = copies.read(data("people/run_4_m_s.csv"))
    scores = play([(f"run {copy}", plain(make(rows).rows, False), [])
                   for copy, make in [("plain", plain), ("slow", copies.slow), ("short", copies.short)]], tmp_path)
    for score in scores:
        assert score["pushes"]["releases"] == 0, judge.line(score)


@pytest.mark.data
@pytest.mark.parametrize("name", ADULTS)
def test_a_recorded_adult_gets_the_pushes(name, tmp_path):
    score, = play([(name, plain(copies.read(data(name))), [])], tmp_path)
    assert_available(score)


@pytest.mark.data
@pytest.mark.parametrize("name", ADULTS + LOOPS)
def test_detection_of_recorded_people(name, tmp_path):
    """No constant was fitted to these people but by their own fitting run."""
    score = fitted(pathlib.Path(data(name)), tmp_path)
    strikes, wrong = errors(score, "heel_strike")
    assert wrong == 0
    assert score["apexes"]["missed"] == 0
    if name in ADULTS:
        assert share(strikes, 0.016) >= 0.98
        toe_offs, wrong = errors(score, "toe_off")
        assert wrong == 0
        assert share(toe_offs, 0.030) >= 0.97
        before, = play([("before", plain(copies.read(data(name))), ["--switches", "none"])], tmp_path)
        assert share(errors(before, "heel_strike")[0], 0.030) >= 0.95
    else:
        assert share(strikes, 0.021) >= 0.90
