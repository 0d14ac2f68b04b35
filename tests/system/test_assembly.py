"""A device that is put together wrongly, on a person who walks: it is noticed before the first push.

What a sensor would say if it were mounted otherwise is made from the person's own columns; the foot switches
keep their feet. Leg sensors with their switches at the other leg, and drives with their latches at the other
leg, are options of `afo sim`. Played are made people everywhere, and recorded ones where AFO_DATA has them.
"""
import json
import math

import pytest

from afo import AFO, data, run
from made_gait import made_gait
from test_people import copies, judge

NOTICED = "sensors or latches misplaced"
SEGMENTS = ("thigh", "shank")
LEGS = ("l", "r")
MADE = {"usual": (1.12, 1.0, 0.0), "slow": (1.5, 0.8, 0.0), "brisk": (0.95, 1.1, 0.0), "limping": (1.2, 0.9, 0.04)}
RECORDED = ["gait_young.csv", "people/gait_middle.csv", "people/child_a_loop_1.csv",
            *(pytest.param(f"people/child_a_loop_{n}.csv", marks=pytest.mark.long) for n in (2, 3, 4))]
SHORT = [*(f"people/child_a_{n}.csv" for n in (1, 2, 3)), "people/plates_a.csv", "people/plates_b.csv",
         "people/circuit_start_stop.csv"]


def swapped(rows, parts):
    """What one leg's sensor should say comes from the other's."""
    return [dict(row, **{f"{part}_{leg}_deg": row[f"{part}_{other}_deg"]
                         for part in parts for leg, other in (LEGS, LEGS[::-1])}) for row in rows]


def changed(rows, columns, change):
    return [dict(row, **{column: change(row[column]) for column in columns}) for row in rows]


def turned(rows, legs):
    return changed(rows, [f"{part}_{leg}_deg" for part in SEGMENTS for leg in legs], lambda angle: -angle)


def slipped(rows, way_m, lever_m=0.12):
    """From a third on the left ankle reads so much more extension."""
    from_s = rows[len(rows) // 3]["time_s"]
    by = math.degrees(way_m / lever_m)
    return [dict(row, ankle_l_deg=row["ankle_l_deg"] - (by if row["time_s"] >= from_s else 0.0)) for row in rows]


MISPLACED = {
    "leg sensors swapped": (lambda rows: swapped(rows, ("thigh", "shank", "ankle")), ()),
    "ankles swapped": (lambda rows: swapped(rows, ("ankle",)), ()),
    "left backwards": (lambda rows: turned(rows, "l"), ()),
    "right backwards": (lambda rows: turned(rows, "r"), ()),
    "both backwards": (lambda rows: turned(rows, "lr"), ()),
    "left ankle stuck at neutral": (lambda rows: changed(rows, ["ankle_l_deg"], lambda _: 0.0), ()),
    "right ankle stuck extended": (lambda rows: changed(rows, ["ankle_r_deg"], lambda _: -10.0), ()),
    "sensors and switches swapped": (lambda rows: rows, ("--fault", "swapped", "--fault-step", "0")),
    "drives crossed": (lambda rows: rows, ("--fault", "crossed", "--fault-step", "0")),
}
TOLERATED = {
    "slipped 5 mm": lambda rows: slipped(rows, 0.005),
    "slipped 10 mm": lambda rows: slipped(rows, 0.010),
    "slipped back 10 mm": lambda rows: slipped(rows, -0.010),
    "ankle scale 0.9": lambda rows: changed(rows, ["ankle_l_deg"], lambda angle: 0.9 * angle),
    "leg scale 0.9": lambda rows: changed(rows, ["thigh_l_deg", "shank_l_deg"], lambda angle: 0.9 * angle),
    "neutral 5 degrees off": lambda rows: changed(rows, ["ankle_l_deg"], lambda angle: angle - 5.0),
    "neutral 5 degrees off the other way": lambda rows: changed(rows, ["ankle_l_deg"], lambda angle: angle + 5.0),
}


def play(rows, tmp_path, options=()):
    path = copies.write(tmp_path / "walk.csv", rows)
    return json.loads(run("--recording", path, "--json", "--quiet", *options).stdout)


def assert_noticed(rows, kind, tmp_path):
    change, options = MISPLACED[kind]
    result = play(change(rows), tmp_path, options)
    assert NOTICED in (result["fault"] or ""), kind
    assert result["left"]["release_s"] + result["right"]["release_s"] == [], kind


def assert_safe_or_noticed(rows, kind, tmp_path):
    score = judge.play(AFO, kind.replace(" ", "-"), copies.Copy(TOLERATED[kind](rows), True, None), [], tmp_path)
    assert score["unsafe"] == 0, judge.line(score)


def assert_well(rows, tmp_path):
    result = play(rows, tmp_path)
    assert result["fault"] is None


@pytest.mark.parametrize("kind", MISPLACED)
@pytest.mark.parametrize("name", ["usual", "slow"])
def test_a_made_person_gets_no_push_of_what_is_misplaced(name, kind, tmp_path):
    assert_noticed(made_gait(20.0, 3, *MADE[name]), kind, tmp_path)


@pytest.mark.parametrize("kind", TOLERATED)
def test_a_made_person_gets_no_wrong_push_of_a_slip(kind, tmp_path):
    assert_safe_or_noticed(made_gait(20.0, 3, *MADE["usual"]), kind, tmp_path)


@pytest.mark.parametrize("name", MADE)
def test_nothing_is_found_on_a_well_fitted_made_person(name, tmp_path):
    assert_well(made_gait(30.0, 3, *MADE[name]), tmp_path)


@pytest.mark.data
@pytest.mark.parametrize("name", RECORDED)
def test_a_recorded_person_gets_no_push_of_what_is_misplaced(name, tmp_path):
    rows = copies.read(data(name))
    for kind in MISPLACED:
        assert_noticed(rows, kind, tmp_path)


@pytest.mark.data
@pytest.mark.parametrize("name", RECORDED)
def test_a_recorded_person_gets_no_wrong_push_of_a_slip(name, tmp_path):
    rows = copies.read(data(name))
    for kind in TOLERATED:
        assert_safe_or_noticed(rows, kind, tmp_path)


@pytest.mark.data
@pytest.mark.parametrize("name", RECORDED + SHORT)
def test_nothing_is_found_on_a_well_fitted_recorded_person(name, tmp_path):
    rows = copies.read(data(name))
    assert_well(rows, tmp_path)
    for copy in ("slow", "short", "limp-40"):
        assert_well(copies.COPIES[copy](rows).rows, tmp_path)
