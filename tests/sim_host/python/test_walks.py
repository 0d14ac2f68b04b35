"""afo.sim() against the command of that name, and laws written in Python behind the controller's limits."""
import os
import signal
import subprocess
import sys
import time

import numpy
import pandas
import pytest

from package_tree import BUILD, ROOT

sys.path.append(str(ROOT / "tests" / "system"))
from made_gait import made_gait  # noqa: E402

SPEED = 0.6


def by_command(path, *arguments):
    """The table that the command writes of a walk."""
    done = subprocess.run([BUILD / "afo", "sim", "--quiet", "--csv", path, *map(str, arguments)], capture_output=True, text=True,
                          check=False)
    assert path.is_file(), done.stderr
    return pandas.read_csv(path)


def same(mine, theirs, digits):
    """Numbers to the digits that the command writes; words alike."""
    assert list(mine.columns) == list(theirs.columns)[:len(mine.columns)] and len(mine) == len(theirs)
    for name in mine.columns:
        if mine[name].dtype.kind == "f":
            assert numpy.allclose(mine[name], theirs[name], atol=10.0 ** -digits, equal_nan=True), name
        elif str(theirs[name].dtype) == "object":
            assert list(mine[name].astype(object).where(mine[name].notna(), "")) == list(theirs[name].fillna("")), name


def test_the_steps_are_those_of_the_command(afo, tmp_path):
    walk = afo.sim(speed=SPEED, steps=12, seed=3)
    theirs = by_command(tmp_path / "steps.csv", "--speed", SPEED, "--steps", 12, "--seed", 3)
    same(walk.steps.drop(columns="used_fallback"), theirs.drop(columns="used_fallback"), 6)
    assert walk and not walk.fell and walk.ended == "" and walk.speed_rad_s == SPEED and walk.ticks is None


def test_the_ticks_are_those_of_the_command(afo, tmp_path):
    ticks = afo.sim(speed=SPEED, steps=4, ticks=True).ticks
    theirs = by_command(tmp_path / "ticks.csv", "--speed", SPEED, "--steps", 4, "--ticks")
    assert abs(len(theirs) - len(ticks)) <= 3  # the command waits for the last frames
    same(ticks.drop(columns="supervisor"), theirs.drop(columns="supervisor").iloc[:len(ticks)], 9)
    assert set(ticks.supervisor.unique()) >= {"walking"} and set(ticks.event.unique()) >= {"apex", "release", "lift_off"}


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A made walk of a person, as a file."""
    path = tmp_path_factory.mktemp("recording") / "person.csv"
    pandas.DataFrame(made_gait(seconds=15.0)).to_csv(path, index=False)
    return path


ADULT = ("adult70", "virtual-adult")
ADULT_FILES = ("--person", "sim_host/persons/adult70.ini", "--device", "sim_host/devices/virtual-adult.ini")


def test_a_recording_is_played_as_by_the_command(afo, recording, tmp_path):
    walk = afo.sim(*ADULT, recording=recording, switches="exact", ticks=True)
    theirs = by_command(tmp_path / "steps.csv", *ADULT_FILES, "--recording", recording, "--switches", "exact",
                        f"--ticks={tmp_path / 'ticks.csv'}")
    same(walk.steps.drop(columns="used_fallback"), theirs.drop(columns="used_fallback"), 6)
    ticks = pandas.read_csv(tmp_path / "ticks.csv")
    same(walk.ticks.drop(columns="supervisor"), ticks.drop(columns="supervisor").iloc[:len(walk.ticks)], 9)
    assert walk and walk.law == "person" and numpy.isnan(walk.speed_rad_s) and walk.ticks.hip_x_m.isna().all()
    assert len(walk.steps) > 15 and walk.steps.r0_m.max() > 0.02


def test_the_events_are_the_recordings(afo, recording):
    """Heel strikes are where the recorded contact begins, toe-offs where it ends; the controller finds them nearby."""
    walk, recorded = afo.sim(*ADULT, recording=recording), pandas.read_csv(recording)
    for side in ("left", "right"):
        edges = numpy.diff(recorded[f"contact_{side[0]}"])
        for kind, edge in (("heel_strike", 1), ("toe_off", -1)):
            at = recorded.time_s.to_numpy()[1:][edges == edge]
            own = walk.events[(walk.events.side == side) & (walk.events.kind == kind)].time_s.to_numpy()
            assert len(own) >= len(at) - 1 and numpy.abs(own - at[:len(own)]).max() < 0.011
            found = walk.found[(walk.found.side == side) & (walk.found.kind == kind)].time_s.to_numpy()
            assert len(found) >= len(own) - 2
            assert max(numpy.abs(own - one).min() for one in found) < 0.05


def test_a_reflex_person_walks_as_by_the_command(afo, tmp_path):
    walk = afo.sim(*ADULT, plant="reflex", steps=4)
    theirs = by_command(tmp_path / "steps.csv", *ADULT_FILES, "--plant", "reflex", "--steps", 4)
    same(walk.steps.drop(columns="used_fallback"), theirs.drop(columns="used_fallback"), 6)


def test_a_law_of_ones_own_serves_a_person(afo, recording):
    """Its answer is given once the device has joined in."""
    walk = afo.sim(*ADULT, law=lambda step: 0.03, recording=recording)
    assert walk.steps.r0_m.iloc[-1] == pytest.approx(0.03, abs=1e-7)


def test_persons_and_devices_by_name(afo, tmp_path):
    assert "adult70" in afo.persons() and "virtual-adult" in afo.devices()
    walk = afo.sim("adult70", "virtual-adult", "predictive", 0.8, steps=3)
    theirs = by_command(tmp_path / "adult.csv", "--person", "sim_host/persons/adult70.ini", "--device",
                        "sim_host/devices/virtual-adult.ini", "--law", "predictive", "--speed", 0.8, "--steps", 3)
    assert numpy.allclose(walk.steps.apex_speed_rad_s, theirs.apex_speed_rad_s, atol=1e-9)


def test_eq_16_in_python_is_eq_16(afo):
    """The same formula in double and in float32: the walks stay together to a float's digits, the told numbers are the table's."""
    told = []

    def law(step):
        told.append(step)
        return step.steady_r0_m - 0.042 * (step.command_rad_s - step.speed_rad_s)
    mine, theirs = afo.sim(law=law, speed=SPEED, steps=25), afo.sim(law="proportional", kp=0.042, speed=SPEED, steps=25)
    assert numpy.allclose(mine.steps.r0_m, theirs.steps.r0_m, atol=1e-6)
    assert [step.step for step in told] == list(mine.steps.step)
    assert numpy.allclose([step.speed_rad_s for step in told], mine.steps.measured_speed_rad_s, atol=1e-7)
    assert numpy.allclose([step.command_rad_s for step in told], mine.steps.target_speed_rad_s, atol=1e-7)
    assert mine.law == "law" and theirs.law == "proportional"


def test_the_limits_stand_behind_a_law(afo):
    """A law that asks for too much, and for nothing, by turns: no change and no value beyond the limits."""
    limits = []

    def law(step):
        limits.append(step)
        return 10.0 if step.step % 2 else -10.0
    walk = afo.sim(law=law, speed=SPEED, steps=12)
    given = walk.steps.r0_m.dropna().to_numpy()
    one = limits[0]
    assert given.min() >= one.r0_min_m - 1e-9 and given.max() <= one.r0_max_m + 1e-9
    assert numpy.abs(numpy.diff(given)).max() <= one.r0_change_max_m + 1e-7 and numpy.abs(numpy.diff(given)).max() > 0.01


def test_a_walking_speed_is_walked(afo):
    """The paper's gait at 0.05 m walks 0.5673 m/s: its step length over the sum of its phases' times."""
    walk = afo.sim(speed="0.5673m/s", steps=8, sensors="ideal")
    assert walk.speed_rad_s == pytest.approx(0.40696, abs=2e-4)
    assert walk.steps.walking_speed_m_s.iloc[3:7].to_numpy() == pytest.approx(0.5673, abs=2e-3)


def test_a_fall_is_told_and_no_error(afo):
    walk = afo.sim(law="open-loop", r0=0.17, steps=400)
    assert not walk and walk.fell and "fallen" in walk.ended and len(walk.steps) < 400


def test_two_walks_at_once_each_have_their_own_law(afo):
    """The GIL is released, and a law belongs to its walk."""
    import concurrent.futures

    def walk(r0):
        return afo.sim(law=lambda step: r0, speed=0.42, steps=8).steps.r0_m.iloc[-1]
    with concurrent.futures.ThreadPoolExecutor() as pool:
        assert list(pool.map(walk, (0.05, 0.052, 0.054))) == pytest.approx([0.05, 0.052, 0.054], abs=1e-7)


@pytest.mark.parametrize("law,kind,words", [
    (lambda step: float("nan"), ValueError, "the law gave nan at step 1; it must give the precompression wanted in m"),
    (lambda step: None, ValueError, "the law gave None at step 1"),
    (lambda step: 1 / 0, ZeroDivisionError, "division by zero"),
    (lambda: 0.05, ValueError, "the law is called with one Step, and does not take it"),
    ("proportionl", ValueError, '"proportionl" is unknown, allowed is .*nearest: proportional'),
    (5, ValueError, "law must be a name or a function, not 5"),
    ("open-loop", ValueError, "the law open-loop needs r0"),
])
def test_a_law_that_does_not_do(afo, law, kind, words):
    with pytest.raises(kind, match=words):
        afo.sim(law=law, speed=None if law == "open-loop" else SPEED, steps=5)


@pytest.mark.parametrize("arguments,words", [
    ({"speed": 9}, "speed 9 is out of range: this law serves this walker from 0.1258 to 1.145 rad/s"),
    ({"speed": "0.57 km/h"}, "it must be a number in rad/s, or a text such as '0.57m/s'"),
    ({"speed": "9m/s"}, "9 m/s"),
    ({"speed": float("nan")}, "speed = nan must be above 0"),
    ({"speed": -0.5}, "speed = -0.5 must be above 0"),
    ({"kp": -0.04}, "kp = -0.04 m per rad/s: it must be 0 to 1"),
    ({"law": "dlqr", "kp": 0.04}, "kp does nothing with the law dlqr"),
    ({"steps": 0}, "steps must be a whole number from 1 to 10000000, not 0"),
    ({"sensors": "13bit"}, 'sensors "13bit" are none of ideal, 17bit, 14bit, 12bit'),
    ({"person": "adult71"}, "person 'adult71' is no file, and none of adult70, paper"),
    ({"device": "/dev/null"}, "/dev/null"),
    ({"slope_deg": 45}, "slope_deg = 45 deg is out of range, allowed is -20 to 20 deg"),
    ({"push": (float("inf"), 1)}, "push = inf"),
    ({"recording": "nobody.csv"}, "recording 'nobody.csv' is no file"),
    ({"recording": __file__}, "no column named"),
    ({"recording": __file__, "speed": 0.8}, "speed is the walker's"),
    ({"recording": __file__, "plant": "reflex"}, "two persons"),
    ({"plant": "person"}, "plant = 'person' is none of walker, reflex"),
    ({"plant": "reflex"}, "name a person of 10 kg or more"),
    ({"plant": "reflex", "law": "dlqr"}, "the law of a person is"),
    ({"recording": __file__, "slope_deg": 1.0}, "a recorded person walks as they did"),
    ({"switches": "exact"}, "under the feet of the person"),
    ({"switches": "new"}, "switches = 'new' are none of none, seeded"),
    ({"r0": 0.1}, "r0 is the constant of the law open-loop; with another law say speed"),
])
def test_settings_that_do_not_fit(afo, arguments, words):
    with pytest.raises(afo.AfoError, match=words):
        afo.sim(**arguments)


@pytest.mark.parametrize("what", [
    "afo.sim(speed=0.8, steps=10**7)",
    "afo.sim(speed=0.8, steps=10**7, law=lambda s: s.steady_r0_m - 0.042 * (s.command_rad_s - s.speed_rad_s))",
    "afo.return_map([[-0.40696, -0.05957, 1.75677]] * 3000, 0.05, 10**9)"])
def test_ctrl_c_ends_what_takes_long(environment, what):
    process = subprocess.Popen([sys.executable, "-c", f"import afo\nprint('begins', flush=True)\n{what}"], env=environment,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=os.setpgrp)
    try:
        assert process.stdout.readline() == "begins\n"
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=20)
    finally:
        process.kill()
    assert process.returncode == -signal.SIGINT or "KeyboardInterrupt" in said
    assert "KeyboardInterrupt" in said and "ignored" not in said
