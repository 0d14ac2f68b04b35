"""A device of parts that can be built, on a person: what it gives, what it leaves alone, and what it says when it
cannot. On a made walk and, where AFO_DATA names a folder with them, on recorded ones."""
import csv
import json
import math

import pytest

from afo import file_of, recording, run, walk, who
from gait_play import write
from made_gait import made_gait

EXO50 = who("adult70", "exo50")
SIDES = ("left", "right")


@pytest.fixture(scope="module")
def worn(person):
    return walk(*EXO50, "--recording", person)


def free_below(leg):
    """The ankle's freedom: 1 N m or 2 % of the peak, whichever is larger."""
    return max(1.0, 0.02 * leg["peak_torque_Nm"])


def test_a_push_in_nearly_every_stance(worn):
    status, result = worn
    assert status == 0
    for side in SIDES:
        leg = result["push"][side]
        assert leg["stances"] > 30 and leg["pushes"] >= 0.95 * leg["stances"]
        assert 25 < leg["peak_torque_Nm"] < 48 and 1 < leg["work_J"] < 8
        assert 45 < leg["release_percent"] < 55
        assert leg["loaded_percent"] < 40
        assert leg["missed_not_loaded"] == leg["missed_latch_open"] == 0
    assert 0.5 < result["push"]["work_symmetry"] <= 1


def test_the_table_of_the_legs_has_the_same_figures(worn, tmp_path, person):
    table = tmp_path / "pushes.csv"
    assert run(*EXO50, "--recording", person, "--pushes", table, "--quiet").returncode == 0
    with open(table, newline="", encoding="utf-8") as file:
        rows = {row.pop("leg"): row for row in csv.DictReader(file)}
    for side in SIDES:
        for name, value in worn[1]["push"][side].items():
            assert float(rows[side][name]) == pytest.approx(value, rel=1e-5)


def test_nothing_resists_in_swing(worn):
    for side in SIDES:
        leg = worn[1]["push"][side]
        assert leg["swing_torque_Nm"] < free_below(leg)


def test_the_motor_stays_within_its_limits(worn):
    for side in SIDES:
        leg = worn[1]["push"][side]
        assert leg["current_rms_A"] < 10.5 and leg["current_peak_A"] <= 30
        assert leg["winding_degC"] < 60 and leg["supply_least_V"] > 30
        assert leg["limited_percent"] < 2
        assert leg["torque_error_rms_Nm"] < 1


@pytest.mark.data
@pytest.mark.parametrize("name", ("gait_young.csv", "people/gait_middle.csv"))
def test_recorded_persons(name):
    status, result = walk(*EXO50, "--recording", recording().parent / name)
    assert status == 0
    for side in SIDES:
        leg = result["push"][side]
        assert leg["pushes"] >= 0.95 * leg["stances"] > 30
        assert leg["swing_torque_Nm"] < free_below(leg)


def changed(path, name, *changes):
    text = file_of("devices", name).read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")
    return ("--person", file_of("persons", "adult70"), "--device", path)


def paced(path, source, pace):
    """The same walk at another pace."""
    with open(source, newline="", encoding="utf-8") as file:
        header, *rows = list(csv.reader(file))
    column = header.index("time_s")
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        for row in rows:
            row[column] = f"{float(row[column]) / pace:.6f}"
            writer.writerow(row)
    return path


def too_slow(folder, source):
    """A motor that is good at normal cadence, at 1.3 times that."""
    device = changed(folder / "slow.ini", "exo50", ("\nspeed_max_m_s = 0.8", "\nspeed_max_m_s = 0.15"),
                     ("speed_limit_m_s = 0.8", "speed_limit_m_s = 0.15"))
    return (*device, "--recording", paced(folder / "fast.csv", source, 1.3))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The made walk: its ankle stays short of the motor, and does not plantarflex before the other foot lands."""
    return write(tmp_path_factory.mktemp("made") / "made.csv", made_gait())


def test_a_motor_too_slow_for_the_pace_pushes_less_and_says_so(tmp_path, made):
    arguments = too_slow(tmp_path, made)
    status, result = walk(*arguments)
    assert status == 0
    assert sum(result["push"][side]["dragged_in_swing"] for side in SIDES) >= 1
    good = walk(*EXO50, "--recording", made)[1]
    for side in SIDES:
        leg = result["push"][side]
        assert leg["peak_torque_Nm"] < 0.8 * good["push"][side]["peak_torque_Nm"]
        assert leg["dragged_in_swing"] <= 3 and leg["swing_torque_Nm"] < 6
    assert "dragged at the foot in swing" in run(*arguments).stdout


def test_before_the_push_nothing_is_pushed(tmp_path, made):
    for arguments in ((*EXO50, "--recording", made), too_slow(tmp_path, made)):
        for side in SIDES:
            assert walk(*arguments)[1]["push"][side]["stance_torque_Nm"] < 1


def test_a_motor_that_cannot_hold_its_spring_says_so(tmp_path, made):
    """Its peak current loads the spring, its I^2 t limit does not hold it: not loaded in time, less is prescribed;
    far too weak, the drive reports a fault, which is no withdrawal."""
    weak = changed(tmp_path / "weak.ini", "exo50", ("current_continuous_A = 10.5 ", "current_continuous_A = 7 "))
    good = walk(*EXO50, "--recording", made)[1]["push"]
    status, result = walk(*weak, "--recording", made)
    assert status == 0
    assert sum(result["push"][side]["missed_not_loaded"] for side in SIDES) >= 1
    assert any(result["push"][side]["limited_percent"] > 5 for side in SIDES)
    for side in SIDES:
        assert result["push"][side]["peak_torque_Nm"] < 0.9 * good[side]["peak_torque_Nm"]
    assert "not loaded in time" in run(*weak, "--recording", made).stdout
    feeble = changed(tmp_path / "feeble.ini", "exo50", ("current_continuous_A = 10.5 ", "current_continuous_A = 4 "))
    done = run(*feeble, "--recording", made)
    assert "STOPPED" in done.stdout and "withdrawn" not in done.stdout


def test_pushes_that_never_come_end_the_assistance(person):
    arguments = (*EXO50, "--recording", person, "--fault", "never-armed", "--fault-step", "30")
    done = run(*arguments)
    assert "not released" in done.stdout and "withdrawn" in done.stdout
    push = walk(*arguments)[1]["push"]
    assert 3 <= sum(push[side]["missed_not_released"] for side in SIDES) <= 4


@pytest.mark.parametrize("change, says", (
    ((("current_peak_A = 30", "current_peak_A = 11"),), "left leg: spring over motor"),
    ((("lever_m = 0.12\nstructure", "lever_m = 0.05\nstructure"),), "left leg: stroke over lever"),
    ((("motor_speed_max_rad_s = 2618", "motor_speed_max_rad_s = 300"),), "left leg: speed over motor"),
    ((("supply_current_max_A = 20", "supply_current_max_A = 1"),), "left leg: energy over supply"),
    ((("latch_holding_N = 900", "latch_holding_N = 300"),), "left leg: spring over latch"),
    ((("speed_max_m_s = 0.8", "speed_max_m_s = 0.08"),), "speed over drive"),
))
def test_what_cannot_be_built_is_refused_before_anything_moves(tmp_path, person, change, says):
    device = changed(tmp_path / "device.ini", "exo50", *change)
    done = run(*device, "--recording", person)
    assert done.returncode == 2 and says in done.stderr and done.stdout == ""


def test_the_lever_of_the_device_is_that_of_the_recorded_ankle(tmp_path, person):
    far = {}
    for lever in ("0.12", "0.1"):
        device = changed(tmp_path / f"{lever}.ini", "exo50", ("ankle_lever_m = 0.12", f"ankle_lever_m = {lever}"),
                         ("\nlever_m = 0.12", f"\nlever_m = {lever}"))
        _, result = walk(*device, "--recording", person)
        far[lever] = result["push"]["left"]["ankle_most_m"]
    assert far["0.1"] == pytest.approx(far["0.12"] / 1.2, rel=1e-4)


def farthest(path, *changes, source):
    _, result = walk(*changed(path, "exo50", *changes), "--recording", source)
    return {side: result["push"][side]["ankle_most_m"] for side in SIDES}


def test_a_leg_s_lever_and_neutral_angle_are_its_own(tmp_path, made):
    """extension = lever sin(plantarflexion - neutral), of the leg whose section says it."""
    plain = farthest(tmp_path / "plain.ini", source=made)
    bent = farthest(tmp_path / "bent.ini", ("[right]\n", "[right]\nankle_neutral_rad = 0.05\n"), source=made)
    short = farthest(tmp_path / "short.ini", ("[right]\n", "[right]\nankle_lever_m = 0.11\n"),
                     ("\n[plant]\n", "\n[right.plant]\nlever_m = 0.11\n[plant]\n"), source=made)
    assert bent["left"] == short["left"] == plain["left"]
    angle = [math.asin(far["right"] / 0.12) for far in (plain, bent)]
    assert angle[0] - angle[1] == pytest.approx(0.05, rel=1e-3)
    assert short["right"] == pytest.approx(plain["right"] * 0.11 / 0.12, rel=1e-4)


def test_both_legs_draw_on_one_battery(tmp_path, made):
    least = {}
    for shared in ("0", "1"):
        device = changed(tmp_path / f"{shared}.ini", "exo50", ("supply_shared = 1", f"supply_shared = {shared}"))
        _, result = walk(*device, "--recording", made)
        least[shared] = min(result["push"][side]["supply_least_V"] for side in SIDES)
    assert least["0"] - 1 < least["1"] < least["0"]
    device = changed(tmp_path / "two.ini", "exo50", ("\n[plant]\n", "\n[right.plant]\nsupply_V = 24\n[plant]\n"))
    done = run(*device, "--recording", made)
    assert done.returncode == 2 and "one battery" in done.stderr and done.stdout == ""


def test_a_compass_walks_with_parts_that_exist():
    """An adult as a compass walker, whose latch takes 5 ms and scatters by 2: the predictive law bears it."""
    status, result = walk(*EXO50, "--law", "predictive", "--steps", "40")
    assert status == 0 and not result["fell"] and result["steps"] == 40
    assert result["apex_speed_rad_s"][-1] == pytest.approx(result["target_speed_rad_s"], rel=0.05)


def size(*arguments):
    return run(file_of("devices", "exo50"), "--person", file_of("persons", "adult70"), *arguments, command="size")


def test_sizing_over_cadence():
    done = size("--cadence", "80..130", "--json", "--chirp")
    assert done.returncode == 0
    result = json.loads(done.stdout)
    assert [row["steps_per_min"] for row in result["cadence"]] == [80, 90, 100, 110, 120, 130]
    for row in result["cadence"]:
        assert row["pushes"] == row["strides"] and 0 < row["margin"] < 1
        assert row["used"][row["limited_by"]] == pytest.approx(1 - row["margin"], abs=1e-3)
        assert row["swing_torque_Nm"] < 1
    assert 1 < result["mass_kg"] < 4 and result["chirp"][0]["gain"] == pytest.approx(1, abs=0.05)
    text = size().stdout
    for word in ("after 1 h", "what limits", "mass", "push-off"):
        assert word in text


def test_the_bandwidth_falls_with_the_force():
    """Robinson, Pratt, Paluska, Pratt (AIM 1999): far above sqrt(k / m) a motor of F_sat moves a mass m by
    F_sat / (m w^2 - k). The current switches between its limits there: 4 / pi of that, as a sine."""
    result = json.loads(size("--cadence", "110", "--json", "--chirp").stdout)
    turns_per_m = 2 * math.pi / 0.002
    mass, force, spring = (3.33e-6 + 1.45e-6) * turns_per_m ** 2, 30 * 0.0136 * turns_per_m, 12000
    amplitude = 0.45 * result["r0_m"]
    for row in result["chirp"]:
        omega = 2 * math.pi * row["frequency_hz"]
        if 20 <= row["frequency_hz"] <= 40:
            bound = 4 / math.pi * force / (mass * omega ** 2 - spring) / amplitude
            assert row["large_gain"] == pytest.approx(bound, rel=0.08)
        assert row["impedance_Nm_rad"] == pytest.approx(10000 * 0.12 ** 2, rel=0.1)
    assert 5 < result["large_force_bandwidth_hz"] < 12 < 25 < result["bandwidth_hz"] < 50


def test_a_motor_that_burns_is_told(tmp_path):
    """Every push is given, and the winding does not bear it: that is no success."""
    device = changed(tmp_path / "hot.ini", "exo50", ("housing_thermal_K_W = 7.4", "housing_thermal_K_W = 30"))[-1]
    done = run(device, "--person", file_of("persons", "adult70"), "--cadence", "100", command="size")
    assert done.returncode == 1 and "beyond the limit at 100 steps/min: winding" in done.stdout
    done = size("--cadence", "100")
    assert done.returncode == 0 and "beyond" not in done.stdout and "ICRA 2015" in done.stdout


def test_sizing_refuses_what_is_not_told():
    assert "--person" in run(file_of("devices", "exo50"), command="size").stderr
    done = run(file_of("devices", "virtual-adult"), "--person", file_of("persons", "adult70"), command="size")
    assert done.returncode == 2 and "[plant]" in done.stderr


def test_what_a_law_bears_of_a_late_latch(tmp_path):
    table = tmp_path / "latch.csv"
    done = run("latch", "--law", "proportional", "--speed", "0.5", "--steps", "60", "--trials", "1", "--csv", table,
               command="study")
    assert done.returncode == 0 and "bears" in done.stdout
    with open(table, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    told = {(row["kind"], row["declared"], row["ms"]): row for row in rows}
    steps = {key: int(row["steps_walked"]) for key, row in told.items()}
    speeds = {key: float(row["speed_rad_s"]) for key, row in told.items()}
    in_time = speeds["delay", "0", "0"]
    assert steps["delay", "0", "0"] == steps["delay", "0", "1"] == 60 and steps["jitter", "0", "20"] < 60
    # Some tenths of a per cent of the speed for each millisecond; where the device declares it, nothing.
    assert 0.0005 < 1 - speeds["delay", "0", "1"] / in_time < 0.009
    assert speeds["delay", "0", "10"] < 0.97 * in_time
    assert steps["delay", "1", "10"] == 60
    assert speeds["delay", "1", "10"] == pytest.approx(in_time, rel=0.002)


def declared(path, name, delay):
    return changed(path, name, ("latch = drive", f"latch = drive\nlatch_delay_s = {delay}"))[-1]


def test_a_declared_delay_is_allowed_for(tmp_path):
    """The virtual latches open at once: told of 10 ms, the law asks for more than is needed, and walks faster."""
    speeds = {}
    for delay in ("0", "0.01"):
        device = declared(tmp_path / f"{delay}.ini", "virtual", delay)
        _, result = walk("--device", device, "--speed", "0.6", "--steps", "80")
        speeds[delay] = result["apex_speed_rad_s"][-1]
    assert 0.01 < speeds["0.01"] / speeds["0"] - 1 < 0.08
    done = run("--device", declared(tmp_path / "slow.ini", "virtual", "0.03"), "--speed", "0.6")
    assert done.returncode == 2 and "latch_delay_s" in done.stderr and "0.025" in done.stderr


def test_a_declared_delay_opens_no_person_s_latch_earlier(tmp_path, made):
    """Every figure is the same, to the last digit: the release keeps its two signs, and the push its energy."""
    plain = changed(tmp_path / "plain.ini", "exo50", ("latch_delay_s = 0.006", "latch_delay_s = 0"))
    push = [walk(*who, "--recording", made)[1]["push"] for who in (plain, EXO50)]
    assert push[0] == push[1]
