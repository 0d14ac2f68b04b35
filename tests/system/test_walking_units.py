"""Walks in the units of gait analysis, beside values that are computed here by other means."""
import csv
import json
import re
import subprocess

import numpy as np
import pytest

from afo import ADULT, AFO, recording, run, walk
from gait_play import read
from reference_walker import GRAVITY, PAPER_GAIT, Walker
from walk_files import columns

STEADY = ("--speed", "0.40696", "--sensors", "ideal", "--steps", "60")


@pytest.fixture(scope="module")
def paper_step():
    """The paper's gait at r0 = 0.05 by the tests' own walker: times, length, margin of stability at heel strike."""
    walker = Walker()
    q, rate = np.array([0.0, PAPER_GAIT[1], 0.0]), np.array([PAPER_GAIT[0], PAPER_GAIT[2], 0.0])
    t1, q, rate = walker.flow(q, rate, None, [walker.heel], lambda q, _: q[0] + q[1], 5.0)
    toe = walker.swing_toe(q)
    mass = walker.masses[::2]
    place = walker.positions(q)[::2]
    speed = (walker.jacobian(walker.positions, q) @ rate)[::2]
    com, com_rate = mass @ place / mass.sum(), mass @ speed / mass.sum()
    margin = -toe[0] + com + com_rate * np.sqrt(walker.l / GRAVITY)  # it walks towards -x
    after = walker.collide(q, rate)
    t2, *_ = walker.flow(q, after, 0.05, [lambda x: walker.swing_toe(x) - toe], lambda q, _: 0.05 - q[2], 5.0)
    _, duration = walker.step(PAPER_GAIT, 0.05)
    return {"length": float(np.hypot(*toe)), "duration": duration, "double": t2, "margin": float(margin),
            "mass": float(mass.sum())}


def test_a_steady_walk_has_the_units_of_its_gait(paper_step):
    told = walk(*STEADY)[1]["walking"]
    length, duration, mass = (paper_step[key] for key in ("length", "duration", "mass"))
    work = 0.5 * 100.0 * 0.05 ** 2  # what a spring of 100 N/m gives from 0.05 m on
    assert told["step_length_m"] == pytest.approx(length, rel=2e-3)
    assert told["walking_speed_m_s"] == pytest.approx(length / duration, rel=2e-3)
    assert told["cadence_per_min"] == pytest.approx(60 / duration, rel=2e-3)
    assert told["double_support_percent"] == pytest.approx(100 * paper_step["double"] / duration, abs=0.15)
    assert told["stance_percent"] == pytest.approx(50 + 50 * paper_step["double"] / duration, abs=0.15)
    assert told["push_off_J"] == pytest.approx(work, rel=5e-3)
    assert told["push_off_J_per_kg"] == pytest.approx(work / mass, rel=5e-3)
    assert told["cost_of_transport"] == pytest.approx(work / (mass * GRAVITY * length), rel=5e-3)
    assert told["margin_of_stability_m"] == pytest.approx(paper_step["margin"], abs=1e-3)
    assert abs(told["step_time_symmetry_percent"]) < 0.1 and told["strides"] > 10


def test_the_fixed_point_has_them_exactly(paper_step):
    done = subprocess.run([AFO, "study", "fixed-point", "--r0", "0.05", "--json"], capture_output=True, text=True, check=True)
    told = json.loads(done.stdout)
    assert told["margin_of_stability_m"] == pytest.approx(paper_step["margin"], abs=2e-6)
    assert told["cadence_per_min"] == pytest.approx(60 / paper_step["duration"], rel=1e-5)
    assert told["double_support_percent"] == pytest.approx(100 * paper_step["double"] / paper_step["duration"], rel=1e-5)
    assert told["stance_percent"] == pytest.approx(50 + 0.5 * told["double_support_percent"], rel=1e-9)
    assert told["push_off_J"] == pytest.approx(0.125, rel=1e-9)
    assert told["push_off_J_per_kg"] == pytest.approx(0.125 / 1.02, rel=1e-9)


def strides_of(person):
    """Per leg: (heel strikes, toe-offs) of the recorded contacts, s."""
    walked = columns(read(person))
    out = {}
    for side in "lr":
        change = np.diff(walked[f"contact_{side}"])
        out[side] = [walked["time_s"][1:][change == sign] for sign in (1, -1)]
    return out


def shares(own, other):
    """(stance, both double supports) of each stride of a leg, as shares of it."""
    (strikes, offs), (other_strikes, other_offs) = own, other
    found = []
    for begin, end in zip(strikes, strikes[1:]):
        def within(times):
            inside = times[(times > begin) & (times < end)]
            return inside[0] if len(inside) else None
        off, other_strike, other_off = within(offs), within(other_strikes), within(other_offs)
        if None not in (off, other_strike, other_off):
            stride = end - begin
            found.append(((off - begin) / stride, (other_off - begin + off - other_strike) / stride))
    return np.array(found)


def compass_step_m(person):
    """From foot to foot of a compass with legs of 1 m that stands as the recorded ones do when a foot comes down."""
    walked = columns(read(person))
    leg = {side: np.radians(walked[f"thigh_{side}_deg"] + walked[f"shank_{side}_deg"]) / 2 for side in "lr"}
    ways = []
    for side, other in ("lr", "rl"):
        down = 1 + np.flatnonzero(np.diff(walked[f"contact_{side}"]) > 0)
        ways.append(np.sin(leg[side][down]) - np.sin(leg[other][down]))
    return np.concatenate(ways).mean()


def test_a_persons_walk_has_the_shares_of_its_contacts(person):
    told = walk("--recording", person)[1]["walking"]
    legs = strides_of(person)
    both = np.concatenate([shares(legs["l"], legs["r"]), shares(legs["r"], legs["l"])])
    assert told["stance_percent"] == pytest.approx(100 * both[:, 0].mean(), abs=0.3)
    assert told["double_support_percent"] == pytest.approx(100 * both[:, 1].mean(), abs=0.4)
    strikes = np.sort(np.concatenate([legs["l"][0], legs["r"][0]]))
    assert told["cadence_per_min"] == pytest.approx(60 / np.diff(strikes).mean(), rel=3e-3)
    side_of = {time: side for side in "lr" for time in legs[side][0]}
    steps = {side: [b - a for a, b in zip(strikes, strikes[1:]) if side_of[b] == side] for side in "lr"}
    left, right = (np.mean(steps[side]) for side in "lr")
    assert told["step_time_symmetry_percent"] == pytest.approx(200 * (left - right) / (left + right), abs=0.3)
    assert told["step_length_m"] == pytest.approx(compass_step_m(person), rel=0.02)
    assert told["way_by_compass"] is True and told["margin_of_stability_m"] is None and told["push_off_J"] is None


def test_a_persons_report_tells_its_events_and_pushes(person):
    text = run("--recording", person).stdout
    legs = strides_of(person)
    result = walk("--recording", person)[1]
    for name, side in (("left", "l"), ("right", "r")):
        line = re.search(rf"events     {name}: (\d+) of (\d+) heel strikes found, .*; (\d+) of (\d+) toe-offs found", text)
        found, strikes, found_offs, offs = map(int, line.groups())
        assert (strikes, offs) == (len(legs[side][0]), len(legs[side][1]))
        assert found == len([t for t in result[name]["recorded_heel_strike_s"]
                             if min(abs(t - s) for s in result[name]["heel_strike_s"]) <= 0.15])
        assert found_offs <= offs
        push = result["push"][name]
        missed = sum(push[key] for key in ("missed_latch_open", "missed_not_loaded", "missed_not_released"))
        assert f"{push['prescribed_given']:.0f} prescribed pushes given, {missed:.0f} missed" in text


@pytest.mark.data
def test_work_per_kilogram_is_of_the_persons_mass():
    result = walk("--recording", recording(), *ADULT)[1]
    leg = result["push"]["left"]
    assert leg["work_J_per_kg"] == pytest.approx(leg["work_J"] / 70.0, rel=1e-4)  # adult70: 65 kg and two legs of 2.5 kg


def test_the_steps_table_has_them_too(tmp_path):
    assert run(*STEADY, "--csv", tmp_path / "steps.csv").returncode == 0
    with open(tmp_path / "steps.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert rows[0]["step_time_s"] == "" and rows[-1]["step_length_m"] == ""  # none, and no 0
    for before, row in zip(rows, rows[1:-1]):
        time = float(row["heel_strike_s"]) - float(before["heel_strike_s"])
        assert float(row["walking_speed_m_s"]) == pytest.approx(float(row["step_length_m"]) / time, rel=1e-4)
        assert float(row["heel_strike_s"]) < float(row["toe_off_s"])


@pytest.mark.parametrize("who", [(), ADULT], ids=["paper", "adult"])
def test_a_walking_speed_is_walked(who):
    told = walk(*who, "--speed", "0.60m/s", "--steps", "120")[1]
    assert told["walking"]["walking_speed_m_s"] == pytest.approx(0.60, rel=0.01)


def test_a_walking_speed_without_a_gait_is_refused_with_the_range():
    done = run("--speed", "3 m/s")
    match = re.search(r"--speed 3 m/s: no gait of this walker and law is so fast; they walk from ([\d.]+) to ([\d.]+) m/s "
                      r"\(([\d.]+) to ([\d.]+) rad/s at the apex\)", done.stderr)
    assert done.returncode == 2 and match
    slow, fast, low, high = map(float, match.groups())
    assert run("--speed", f"{slow - 0.01}m/s").returncode == 2
    for metres, radians in ((slow, low), (fast, high)):
        inside = metres + (0.002 if metres == slow else -0.002)
        target = walk("--speed", f"{inside}m/s", "--steps", "1")[1]["target_speed_rad_s"]
        assert target == pytest.approx(radians, rel=0.02)


@pytest.mark.parametrize("text", ["fast", "1.1m/x", "1.1 km/h", "m/s", ""])
def test_a_speed_that_is_none_is_answered_with_examples(text):
    done = run("--speed", text)
    assert done.returncode == 2 and f"--speed: \"{text}\" is no speed" in done.stderr and "0.57m/s" in done.stderr


def test_rad_per_second_may_be_written_out():
    assert walk("--speed", "0.5rad/s", "--steps", "2")[1]["target_speed_rad_s"] == 0.5
