"""Every table that the programs write is one for a plain pandas.read_csv, tells beside it what it is, and goes on as
Parquet and as an OpenSim motion."""
import json
import math
import xml.etree.ElementTree

import numpy as np
import pandas
import pyarrow.parquet
import pytest

from afo import ROOT, run
from gait_play import write
from made_gait import made_gait

# Columns of words; all others are numbers, true or false, or empty.
WORDS = {"side", "stance", "phase", "event", "supervisor", "leg", "law", "kind", "sensor", "case", "direction", "end", "fault",
         "bound", "ground", "branch"}
SHORT = ("--speed", "0.45", "--steps", "6", "--quiet")


def made(path, *arguments, command="sim"):
    done = run(*arguments, command=command)
    assert done.returncode in (0, 1), done.stderr
    return path


def tables(folder):
    """(name, file) of a table of each kind that a program writes."""
    steps, ticks, pushes = (folder / f"{name}.csv" for name in ("steps", "ticks", "pushes"))
    made(steps, *SHORT, "--csv", steps, f"--ticks={ticks}", "--pushes", pushes)
    recording = write(folder / "person.csv", [row for row in made_gait() if row["time_s"] < 8.0])
    walked = folder / "walked.csv"
    made(walked, "--recording", recording, "--quiet", "--csv", walked, "--pushes", folder / "pushes2.csv")
    yield from {"steps": steps, "ticks": ticks, "pushes": pushes, "walked": walked,
                "pushes of a person": folder / "pushes2.csv"}.items()
    for name, words in {"fixed-point": ("--r0", "0.05"), "map": ("--r0", "0.05", "--steps", "5"),
                        "continue": ("--from", "0.05", "--to", "0.07"), "basin": ("--points", "4", "--strides", "20"),
                        "doublings": ("--count", "1", "--from", "0.05", "--to", "0.1"),
                        "bifurcation": ("--points", "3", "--transient", "20"),
                        "gain": ("--kp", "0.042", "--from", "0.05", "--to", "0.1", "--points", "3"),
                        "noise": ("--walkers", "2", "--strides", "5")}.items():
        path = folder / f"{name}.csv"
        yield name, made(path, name, *words, "--csv", "--out", path, "--quiet", command="study")
    for name in ("slope", "energy", "timing"):
        yield f"laws {name}", made(folder / f"laws-{name}.csv", "laws", name, "--samples", "2", "--out", folder, "--law", "dlqr",
                                   command="study")
    yield "faults", made(folder / "fault.csv", "--run", "7", "--csv", folder / "fault.csv", command="faults")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    return dict(tables(tmp_path_factory.mktemp("tables")))


def plain(tables_of):
    for name, path in tables_of.items():
        table = pandas.read_csv(path)
        assert len(table) > 0, name
        assert not [column for column in table if column.startswith(("Unnamed", "#"))], name
        words = {column for column in table if table[column].dtype == object}
        assert words <= WORDS, (name, words)
        for column in table.columns.difference(list(words)):
            values = table[column]
            assert not np.isinf(values.astype(float)).any(), (name, column)


def told_beside(tables_of):
    for name, path in tables_of.items():
        told = json.loads(path.with_name(path.name + ".json").read_text())
        assert told["version"] and told["build_id"] and told["program"].startswith("afo "), name


def test_every_table_is_plain(written):
    plain(written)


def test_every_table_says_beside_it_what_it_is(written):
    told_beside(written)


@pytest.mark.long
def test_tables_of_long_studies_are_plain_and_told_of(tmp_path):
    found = {name: made(tmp_path / f"{name}.csv", name, *words, "--csv", tmp_path / f"{name}.csv", command="study")
             for name, words in {"observe": ("--steps", "10"), "latch": ("--steps", "10", "--trials", "1", "--law", "dlqr")}.items()}
    plain(found)
    told_beside(found)


def test_what_is_not_known_is_empty_and_no_0(written):
    steps, walked = (pandas.read_csv(written[name]) for name in ("steps", "walked"))
    assert math.isnan(steps["step_time_s"][0]) and math.isnan(steps["step_length_m"].iloc[-1])
    assert walked["push_off_J"].isna().all() and walked["margin_of_stability_m"].isna().all()
    for table in (steps, walked):
        for column in ("step_time_s", "step_length_m", "walking_speed_m_s"):
            assert not (table[column] == 0).any()


def test_states_are_words(written):
    ticks = pandas.read_csv(written["ticks"])
    assert set(ticks["supervisor"]) <= {"init", "self_test", "standby", "engaging", "walking", "unloading"}
    assert "walking" in set(ticks["supervisor"]) and set(ticks["stance"]) == {"left", "right"}
    assert {"apex", "release", "lift_off"} <= set(ticks["event"].dropna())


def test_steps_and_ticks_of_one_run_have_one_clock(written):
    steps, ticks = pandas.read_csv(written["steps"]), pandas.read_csv(written["ticks"])
    for column, event in (("time_s", "apex"), ("toe_off_s", "lift_off")):
        at = ticks["time_s"][ticks["event"] == event].to_numpy()
        for time in steps[column].dropna():
            assert 0 <= np.min(np.where(at >= time - 1e-6, at - time, np.inf)) + 1e-6 < 2.1e-3, (column, time)


def test_one_table_of_steps_is_the_same_with_and_without_ticks(written, tmp_path):
    alone = made(tmp_path / "steps.csv", *SHORT, "--csv", tmp_path / "steps.csv")
    assert alone.read_bytes() == written["steps"].read_bytes()
    ticks = made(tmp_path / "ticks.csv", *SHORT, "--csv", tmp_path / "ticks.csv", "--ticks")
    assert ticks.read_bytes() == written["ticks"].read_bytes()


def test_a_study_on_standard_output_is_a_table_and_nothing_else():
    done = run("fixed-point", "--r0", "0.05", "--csv", command="study")
    assert [len(line.split(",")) for line in done.stdout.splitlines()] == [8, 8]
    assert "cost_of_transport: 0.0231855" in done.stderr


@pytest.mark.parametrize("name", ["steps", "ticks", "pushes", "continue"])
def test_parquet_has_the_same_values_units_and_what_was_told(written, name, tmp_path):
    path = tmp_path / "table.parquet"
    assert run(written[name], "--out", path, command="export").returncode == 0
    table = pyarrow.parquet.read_table(path)
    text = pandas.read_csv(written[name], float_precision="round_trip")
    assert table.column_names == list(text.columns)
    for column in text:
        values = table.column(column).to_pandas()
        if text[column].dtype == object:
            assert values.fillna("").tolist() == text[column].fillna("").tolist()
        else:
            np.testing.assert_array_equal(values.astype(float), text[column].astype(float))
    beside = written[name].with_name(written[name].name + ".json")
    assert json.loads(table.schema.metadata[b"experiment"]) == json.loads(beside.read_text())
    if name == "steps":
        units = {field.name: field.metadata[b"unit"].decode() for field in table.schema}
        assert (units["apex_speed_rad_s"], units["step_length_m"], units["push_off_J"]) == ("rad/s", "m", "J")


def storage(path):
    """An OpenSim table, by pandas."""
    lines = path.read_text().splitlines()
    head = dict(line.split("=", 1) for line in lines[:lines.index("endheader")] if "=" in line)
    return head, pandas.read_csv(path, sep="\t", skiprows=lines.index("endheader") + 1)


def test_a_walk_as_an_opensim_motion(written, tmp_path):
    path = tmp_path / "walk.mot"
    assert run(written["ticks"], "--out", path, command="export").returncode == 0
    head, motion = storage(path)
    ticks = pandas.read_csv(written["ticks"])
    assert int(head["nRows"]) == len(motion) == len(ticks) and int(head["nColumns"]) == len(motion.columns)
    assert head["inDegrees"] == "yes" and json.loads(head["experiment"])["program"] == "afo sim"
    np.testing.assert_allclose(np.radians(motion["hip_flexion_r"]), ticks["theta_right_rad"], atol=1e-8)
    assert motion["pelvis_tx"].iloc[-1] > 1.5  # it went forwards
    # The leg's pitch and the way of the hip agree: in the single support of a locked ankle x = -l sin(pitch).
    single = (ticks["phase"] == "single") & (ticks["stance"] == "left")
    moved = np.diff(motion["pelvis_tx"])[single.to_numpy()[:-1]]
    turned = -np.diff(np.sin(np.radians(motion["hip_flexion_l"])))[single.to_numpy()[:-1]]
    assert np.corrcoef(moved, turned)[0, 1] > 0.97


def roll_over(forces, letter, ball_x_m):
    """A stance begins at the heel, as far behind the ball as a foot that lands reaches, ends at the ball, and never lies outside."""
    down = (forces[f"ground_force_{letter}_vy"] > 20).to_numpy()
    behind_m = (ball_x_m - forces[f"ground_force_{letter}_px"]).to_numpy()
    ends = np.flatnonzero(down[:-1] & ~down[1:])
    begins = np.flatnonzero(~down[:-1] & down[1:]) + 1
    assert len(begins) >= 2 and len(ends) >= 2
    assert np.all(np.abs(behind_m[ends]) < 1e-3)
    foot_m = behind_m[begins]
    assert np.ptp(foot_m) < 0.03 and 0.12 < foot_m.mean() < 0.25
    assert behind_m[down].min() > -1e-3 and behind_m[down].max() < foot_m.max() + 0.01


def test_a_person_who_bends_their_knees_as_an_opensim_motion(tmp_path):
    """From the hip by the motion's angles alone: the ankle is as far from the ball as a foot is long, and the foot as it is turned."""
    ticks, path = tmp_path / "ticks.csv", tmp_path / "walk.mot"
    made(ticks, "--plant", "reflex", "--person", ROOT / "sim_host/persons/reflex-new.ini", "--device",
         ROOT / "sim_host/devices/virtual-adult.ini", "--without-device", "--steps", "6", "--quiet", f"--ticks={ticks}")
    done = run(ticks, "--out", path, command="export")
    assert done.returncode == 0 and "N, at the centres of pressure" in done.stdout
    told, table = json.loads(ticks.with_name("ticks.csv.json").read_text()), pandas.read_csv(ticks)
    _, motion = storage(path)
    part = told["who"]["leg_length_m"] / 2
    for side, letter in (("left", "l"), ("right", "r")):
        thigh = np.radians(motion["pelvis_tilt"] + motion[f"hip_flexion_{letter}"])
        shank = thigh - np.radians(motion[f"knee_angle_{letter}"])
        foot = shank + np.radians(motion[f"ankle_angle_{letter}"])
        ankle = np.array([motion["pelvis_tx"] + part * (np.sin(thigh) + np.sin(shank)),
                          motion["pelvis_ty"] - part * (np.cos(thigh) + np.cos(shank))])
        ball = np.array([-table[f"toe_{side}_x_m"], table[f"toe_{side}_y_m"]]) - ankle
        along = (np.cos(foot) * ball[0] + np.sin(foot) * ball[1], -np.sin(foot) * ball[0] + np.cos(foot) * ball[1])
        assert np.std(along[0]) < 1e-6 and np.std(along[1]) < 1e-6 and np.mean(along[0]) > 0.1
        assert motion[f"knee_angle_{letter}"].max() > 40 and motion[f"knee_angle_{letter}"].min() > -5
        roll_over(storage(tmp_path / "walk_grf.mot")[1], letter, -table[f"toe_{side}_x_m"])
    assert np.degrees(table["trunk_lean_rad"]).to_numpy() == pytest.approx(-motion["pelvis_tilt"].to_numpy(), abs=1e-6)


def test_a_motion_has_its_ground_forces_beside_it(tmp_path):
    """Over a whole stride they carry the weight, and from step to step they change no speed; a foot that swings has none."""
    ticks, path = tmp_path / "ticks.csv", tmp_path / "walk.sto"
    made(ticks, "--speed", "0.45", "--steps", "12", "--sensors", "ideal", "--quiet", f"--ticks={ticks}")
    done = run(ticks, "--out", path, command="export")
    assert done.returncode == 0 and f"{tmp_path / 'walk_grf.sto'}: the ground's forces" in done.stdout
    head, forces = storage(tmp_path / "walk_grf.sto")
    assert int(head["nRows"]) == len(forces) and int(head["nColumns"]) == len(forces.columns) and head["inDegrees"] == "no"
    table = pandas.read_csv(ticks)
    strikes = table.index[(table["event"] == "lift_off")]
    steps = forces.iloc[strikes[4]:strikes[8]]
    both = sum(steps[f"ground_force_{side}_vy"] for side in "lr")
    # The impulse of two impacts that fall between ticks is missing: at this speed a few percent of the weight's.
    assert both.mean() == pytest.approx(1.02 * 9.80665, rel=0.06) and (both > 0).all()
    swings = (table["phase"] == "single") & (table["stance"] == "left")
    assert (forces["ground_force_r_vy"][swings] == 0).all() and (forces["ground_force_l_vy"][swings] > 0).all()
    stands = forces["ground_force_l_px"][swings].to_numpy()
    assert (np.abs(np.diff(stands)) < 1e-9).mean() > 0.9  # the toe stands still
    assert forces["ground_force_l_px"].iloc[-1] - forces["ground_force_l_px"].iloc[0] > 2.0  # forwards


def test_the_motion_comes_back_as_a_recording(tmp_path):
    """`afo import` finds the legs and the contacts in both files."""
    ticks, path, back = tmp_path / "ticks.csv", tmp_path / "walk.mot", tmp_path / "back.csv"
    made(ticks, "--speed", "0.45", "--steps", "12", "--quiet", f"--ticks={ticks}")
    assert run(ticks, "--out", path, command="export").returncode == 0
    done = run(path, "--forces", tmp_path / "walk_grf.mot", "--out", back, "--contact-over", "0.5", "--ankle-neutral", "0",
               command="import")
    assert done.returncode == 1, done.stdout + done.stderr  # a compass has no ankle angle, and that is said
    table, told = pandas.read_csv(ticks), pandas.read_csv(back)
    assert len(told) > 0.9 * len(table)
    for side, letter in (("left", "l"), ("right", "r")):
        # The compass of equal thigh and shank: the thigh's pitch is the leg's.
        theta = np.degrees(np.interp(told["time_s"], table["time_s"], table[f"theta_{side}_rad"]))
        assert np.abs(told[f"thigh_{letter}_deg"] - theta).max() < 0.5
        down = np.interp(told["time_s"], table["time_s"], table[f"ground_{side}_y_N"]) > 0.5
        assert (told[f"contact_{letter}"].astype(bool) == down).mean() > 0.99


def test_a_persons_ticks_have_phases_and_no_place(written, tmp_path):
    """What a recording does not tell is empty; which foot stands is as the recording says."""
    ticks = made(tmp_path / "ticks.csv", "--recording", written["walked"].with_name("person.csv"), "--quiet",
                 f"--ticks={tmp_path / 'ticks.csv'}")
    table = pandas.read_csv(ticks)
    for name in ("hip_x_m", "hip_y_m", "toe_left_x_m", "ground_right_y_N"):
        assert table[name].isna().all()
    assert set(table["phase"].dropna()) == {"single", "double"} and set(table["stance"].dropna()) == {"left", "right"}
    recorded = pandas.read_csv(written["walked"].with_name("person.csv"))
    both = np.interp(table["time_s"], recorded["time_s"], recorded["contact_l"] * recorded["contact_r"])
    assert ((table["phase"] == "double") == (both > 0.5)).mean() > 0.98


def test_a_walk_as_a_moving_picture(written, tmp_path):
    """No script; every leg's upper end is the hip, and the stance toe stands still while its ankle is locked."""
    path = tmp_path / "walk.svg"
    assert run(written["ticks"], "--out", path, command="export").returncode == 0
    picture = xml.etree.ElementTree.parse(path)
    svg = "{http://www.w3.org/2000/svg}"
    assert "script" not in path.read_text().lower()
    legs = [line for line in picture.iter(f"{svg}line") if len(line)]
    paths = [{one.get("attributeName"): np.array([float(v) for v in one.get("values").split(";")]) for one in leg} for leg in legs]
    hip = {one.get("attributeName"): one.get("values") for one in next(picture.iter(f"{svg}circle"))}
    assert len(legs) == 2 and all(one.find(f"{svg}animate").get("values") == hip["cx"] for one in legs)
    ticks = pandas.read_csv(written["ticks"])
    assert len(paths[0]["x1"]) == pytest.approx(ticks["time_s"].iloc[-1] * 25, abs=2)
    at = ticks.iloc[(np.arange(len(paths[0]["x1"])) * 40).clip(max=len(ticks) - 1)].reset_index()
    stands = (at["phase"] == "single") & (at["stance"] == "left")
    both = (stands & stands.shift(-1, fill_value=False)).to_numpy()[:-1]
    assert both.sum() > 20
    assert np.abs(np.diff(paths[0]["x2"])[both]).max() < 0.25 and np.abs(paths[0]["y2"][:-1][both] - 360).max() < 0.5
    assert paths[0]["x1"][-1] - paths[0]["x1"][0] > 300  # pixels to the right: forwards


@pytest.mark.parametrize("table,out,words", [
    ("steps", "walk.svg", "a moving picture is made of a table of ticks"),
    ("steps", "walk.mot", "a motion is made of a table of ticks (afo sim --ticks=FILE), and this one lacks theta_left_rad"),
    ("steps", "walk.xls", "its ending says in what format, and is one of .parquet, .mot, .sto, .svg"),
    ("nothing", "walk.parquet", "No such file"),
])
def test_what_cannot_be_exported_is_refused_in_words(written, table, out, words, tmp_path):
    done = run(written.get(table, tmp_path / "nothing.csv"), "--out", tmp_path / out, command="export")
    assert done.returncode == 2 and words in done.stderr and not list(tmp_path.iterdir())


def test_two_tables_in_one_file_are_refused(tmp_path):
    done = run("--csv", tmp_path / "a.csv", f"--ticks={tmp_path / 'a.csv'}")
    assert done.returncode == 2 and "--csv and --ticks name the same file" in done.stderr
