"""Gait events of a recorded person: against the recorded foot contacts, and under
perturbations that no detector may be tuned to (another pace, legs exchanged, drifting
sensors, lost samples, smaller steps, other column names and rates).

Played are a made walk and, where AFO_DATA names a folder with it, a recorded one (conftest.py).
"""
import csv
import math
import random

import pytest

from afo import run, walk
from gait_play import SIDES, apexes, changes, read, write


@pytest.fixture(scope="module")
def rows(person):
    return read(person)


def errors(found, truth, skip_s=0.3):
    """Of each true event but those at the very ends; every found event has one true event."""
    first, last = truth[0] + skip_s, truth[-1] - skip_s
    inner = [t for t in truth if first <= t <= last]
    off = [min((f - t for f in found), key=abs) for t in inner]
    for f in found:
        if first <= f <= last:
            assert min(abs(f - t) for t in truth) < 0.15, f"event at {f} s that was none"
    assert all(b - a > 0.3 for a, b in zip(found, found[1:])), "an event twice"
    return off


def share_within(off, limit_s):
    return sum(abs(e) <= limit_s for e in off) / len(off)


def judge(result, rows, toe_off_shares=(0.85, 0.97)):
    """The criteria; toe-off's 16 ms share is held to what the recording's own contact data
    allow: 14 of its 88 toe-offs lie 17 to 30 ms from their leg's median against every feature
    of thigh, shank, leg, ankle and foot alike, while half of all lie within 5 ms of it."""
    strikes, toe_offs = [], []
    for name, side in SIDES.items():
        leg = result[name]
        assert len(leg["apex_s"]) == len(apexes(rows, side))
        strikes += errors(leg["heel_strike_s"], changes(rows, side, 1))
        toe_offs += errors(leg["toe_off_s"], changes(rows, side, 0))
        for event in ("apex", "heel_strike", "toe_off"):
            delays = [known - at for at, known in zip(leg[f"{event}_s"], leg[f"{event}_known_s"])]
            assert len(leg[f"{event}_s"]) == len(leg[f"{event}_known_s"])
            assert all(0 <= delay < 0.06 for delay in delays)
        assert leg["gait_phase_error_rms"] < 0.05
    assert share_within(strikes, 0.016) > 0.98
    assert share_within(toe_offs, 0.016) > toe_off_shares[0]
    assert share_within(toe_offs, 0.030) > toe_off_shares[1]


def test_events_of_the_recording(person, rows):
    _, result = walk("--recording", person)
    judge(result, rows)


@pytest.mark.parametrize("sensors", ["ideal", "14bit", "12bit"])
def test_other_sensors(person, rows, sensors):
    _, result = walk("--recording", person, "--sensors", sensors)
    judge(result, rows)


@pytest.mark.parametrize("scale", [0.75, 0.9, 1.15])
def test_another_pace(rows, scale, tmp_path):
    """Slower, the scatter of the recorded contacts is slower too."""
    other = [dict(row, time_s=row["time_s"] * scale) for row in rows]
    _, result = walk("--recording", write(tmp_path / "pace.csv", other))
    judge(result, other, toe_off_shares=(0.8, 0.95))


def test_slow_and_short_steps(rows, tmp_path):
    """0.7 of the amplitude at 1.4 times the period: a slow walker. The contact data's own
    scatter is stretched too, so only what is robust is asked: none missed, none false."""
    other = [{key: value * 1.4 if key == "time_s" else
              value * 0.7 if key.split("_")[0] in ("thigh", "shank") else value
              for key, value in row.items()} for row in rows]
    _, result = walk("--recording", write(tmp_path / "slow.csv", other))
    for name, side in SIDES.items():
        off = errors(result[name]["heel_strike_s"], changes(other, side, 1))
        assert share_within(off, 0.030) > 0.98
        off = errors(result[name]["toe_off_s"], changes(other, side, 0))
        assert share_within(off, 0.060) > 0.98


def test_legs_exchanged(person, rows, tmp_path):
    swap = {"l": "r", "r": "l"}

    def other_leg(key):
        parts = key.split("_")
        return "_".join([parts[0], swap[parts[1]]] + parts[2:]) if parts[1] in swap else key
    other = [{key: row[other_leg(key)] for key in row} for row in rows]
    _, result = walk("--recording", write(tmp_path / "mirror.csv", other))
    _, plain = walk("--recording", person, "--sensors", "ideal")
    judge(result, other)
    for name, opposite in (("left", "right"), ("right", "left")):
        assert result[name]["heel_strike_s"] == \
            pytest.approx(plain[opposite]["heel_strike_s"], abs=0.002)


def test_drifting_sensors(rows, tmp_path):
    other = []
    for row in rows:
        drift = {"l": 3.0 * math.sin(row["time_s"] / 3.0), "r": 2.0 * math.sin(row["time_s"] / 5.0)}
        other.append({key: value + drift[key.split("_")[1]]
                      if key.split("_")[0] in ("thigh", "shank") else value
                      for key, value in row.items()})
    _, result = walk("--recording", write(tmp_path / "drift.csv", other))
    judge(result, other)


def test_lost_samples_and_noise(rows, tmp_path):
    rng = random.Random(1)
    other, lost = [], 0
    for row in rows:
        if other and lost == 0 and rng.random() < 0.01:
            lost = rng.randint(1, 6)
        if lost > 0:
            lost -= 1
            continue
        other.append({key: value + rng.gauss(0.0, 0.1)
                      if key.split("_")[0] in ("thigh", "shank") else value
                      for key, value in row.items()})
    _, result = walk("--recording", write(tmp_path / "lost.csv", other))
    for name, side in SIDES.items():
        assert len(result[name]["apex_s"]) == len(apexes(other, side))
        off = errors(result[name]["heel_strike_s"], changes(rows, side, 1))
        assert share_within(off, 0.020) > 0.95
        errors(result[name]["toe_off_s"], changes(rows, side, 0))


def test_the_device_pushes_off_after_the_other_foot_has_landed(person, rows):
    """On every step after engagement: released between 20 ms before the other foot's
    recorded strike and the own toe-off."""
    _, result = walk("--recording", person)
    for name, side in SIDES.items():
        other = "r" if side == "l" else "l"
        strikes, toe_offs = changes(rows, other, 1), changes(rows, side, 0)
        releases = result[name]["release_s"]
        assert len(releases) >= len(toe_offs) - 4  # four steady steps, two a leg, then loading
        assert all(b - a < 1.5 for a, b in zip(releases, releases[1:])), "a step left out"
        for release in releases:
            if release < strikes[-1] + 0.02:
                assert min(abs(release - strike) for strike in strikes) < 0.06
            later = [t for t in toe_offs if t > release - 0.02]
            if later:
                assert 0.03 < later[0] - release < 0.25


def test_other_columns_and_rates(rows, tmp_path):
    names = {"thigh_l_deg": "LT Thigh", "shank_l_deg": "LT Shank", "thigh_r_deg": "RT Thigh",
             "shank_r_deg": "RT Shank", "contact_l": "LT", "contact_r": "RT"}
    half = [{new: row[old] for old, new in names.items()} for row in rows[::2]]
    path = tmp_path / "other.csv"
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=half[0].keys())
        writer.writeheader()
        writer.writerows(half)
    columns = []
    for old, new in names.items():
        columns += ["--column", f"{old.removesuffix('_deg')}={new}"]
    _, result = walk("--recording", path, "--rate", 100, "--column", "time=", "--column", "ankle_l=",
                     "--column", "ankle_r=", *columns)
    judge(result, rows)


def test_unknown_roles_are_refused():
    for column in ("knee_l=Knee", "thigh_l", "=x"):
        done = run("--recording", "x.csv", "--column", column)
        assert done.returncode == 2
        assert "thigh_l" in done.stderr


def test_times_count_as_the_file_does(rows, tmp_path):
    late = [dict(row, time_s=row["time_s"] + 100.0) for row in rows[:2000]]
    _, plain = walk("--recording", write(tmp_path / "plain.csv", rows[:2000]))
    _, result = walk("--recording", write(tmp_path / "late.csv", late))
    for name in SIDES:
        for key in ("apex_s", "heel_strike_known_s", "toe_off_s", "recorded_toe_off_s"):
            assert result[name][key] == pytest.approx([t + 100.0 for t in plain[name][key]],
                                                      abs=2e-6)


def test_angles_in_radians(rows, tmp_path):
    other = [{key: math.radians(value) if key.endswith("_deg") else value
              for key, value in row.items()} for row in rows[:2000]]
    path = write(tmp_path / "rad.csv", other)
    _, plain = walk("--recording", write(tmp_path / "deg.csv", rows[:2000]))
    _, result = walk("--recording", path, "--angles", "rad")
    assert result["left"]["heel_strike_s"] == pytest.approx(plain["left"]["heel_strike_s"],
                                                            abs=1e-3)
    done = run("--recording", path, "--json", "--quiet")
    assert "--angles rad" in done.stderr
    assert run("--recording", path, "--angles", "turns").returncode == 2
