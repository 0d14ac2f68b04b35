"""A person who walks by reflexes, in closed loop with the device over the in-process bus."""
import csv
import json
import math
import xml.etree.ElementTree

import pytest

from afo import file_of, run

WORN = ("--plant", "reflex", "--person", "sim_host/persons/adult70.ini", "--device", "sim_host/devices/virtual-adult.ini")


def test_the_device_finds_the_steps_of_a_reflex_person(tmp_path):
    """Their legs are late and early as muscles make them, and nobody recorded them."""
    walked = run(*WORN, "--steps", "12", "--json", "--quiet", "--log", tmp_path / "one.log")
    assert walked.returncode == 0, walked.stderr
    told = json.loads(walked.stdout)
    assert told["steps"] == 12 and not told["fell"] and told["fault"] is None
    assert told["apexes_left"] >= 5 and told["apexes_right"] >= 5
    again = run(*WORN, "--steps", "12", "--json", "--quiet", "--log", tmp_path / "two.log")
    assert again.returncode == 0
    assert (tmp_path / "one.log").read_bytes() == (tmp_path / "two.log").read_bytes()


def test_the_papers_walker_is_no_person():
    refused = run("--plant", "reflex", "--steps", "3")
    assert refused.returncode == 2
    assert "name a person of 10 kg or more with --person" in refused.stderr


def test_there_is_one_wearer():
    refused = run("--plant", "reflex", "--recording", "x.csv")
    assert refused.returncode == 2 and "there is one wearer" in refused.stderr
    refused = run("--plant", "compass")
    assert refused.returncode == 2 and "walker, reflex" in refused.stderr.replace(" or", ",")


ALONE = (*WORN, "--without-device")


def told(*arguments, fell=False):
    done = run(*ALONE, "--json", "--quiet", *arguments)
    assert done.returncode == (1 if fell else 0), done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize("degrees", [0.5, -0.5])
def test_uphill_and_downhill(tmp_path, degrees):
    """0.05 degrees more a step, up to the slope asked for: what the hip rises is its integral over the way."""
    ticks = tmp_path / "ticks.csv"
    told("--steps", "20", f"--ticks={ticks}", "--slope-deg", degrees)
    with ticks.open(encoding="utf-8") as file:
        rows = [(float(row["time_s"]), -float(row["hip_x_m"]), float(row["hip_y_m"])) for row in csv.DictReader(file)]
    highest = [max(y for time_s, _, y in rows if time_s > low and time_s < low + 1.4) for low in (1.0, rows[-1][0] - 1.4)]
    step_m = (rows[-1][1] - rows[0][1]) / 20
    ramp_m, whole_m = 10 * step_m, 9 * step_m
    expected_m = math.radians(degrees) * (0.5 * ramp_m + whole_m)
    assert highest[1] - highest[0] == pytest.approx(expected_m, rel=0.2)


def test_a_push_is_borne_or_ends_on_the_side_it_goes_to():
    calm, pushed, spread = (told("--steps", "8", *push)["apex_speed_rad_s"]
                            for push in ((), ("--push", "5@3"), ("--push", "5@3/0.2")))
    assert calm[:3] == pushed[:3] and calm[5:] != pushed[5:] and spread[5:] != pushed[5:]
    assert told("--steps", "30", "--push", "200@4", fell=True)["fault"].startswith("fallen_forward")
    assert told("--steps", "30", "--push", "-200@4", fell=True)["fault"].startswith("fallen_backward")


def test_rough_ground_is_the_seeds():
    one, again, other = (told("--steps", "8", "--terrain-mm", "0.5", "--seed", seed)["apex_speed_rad_s"] for seed in (1, 1, 2))
    assert one == again and one != other


@pytest.mark.parametrize("phase_ms", [0, 300, 600, 900])
def test_whose_drives_are_pulled_walks_on(phase_ms):
    """From then on no frame reaches a drive or leaves it: the controller says so, and the person walks on without."""
    done = run(*WORN, "--json", "--quiet", "--steps", "30", "--fault", "cut-drives", "--fault-step", "9",
               "--fault-ms", phase_ms)
    result = json.loads(done.stdout)
    assert not result["fell"] and result["steps"] == 30 and "drive silent" in result["fault"]
    assert result["experiment"]["injected_fault"] == {"name": "cut-drives", "after_step": 9, "and_ms": phase_ms}


def test_the_dose_and_its_time_are_asked_for():
    """r0* is the spring's precompression; a late latch makes each push come later after the strike of the other foot."""
    late_s = {}
    for late_ms in (0, 30):
        walked = run(*WORN, "--json", "--quiet", "--steps", "18", "--start-r0", "0.01", "--release-late-ms", late_ms)
        result = json.loads(walked.stdout)
        assert max(result["r0_m"]) == pytest.approx(0.01, rel=0.1)
        strikes = result["right"]["recorded_heel_strike_s"]
        release_s = result["left"]["release_s"][0]
        late_s[late_ms] = release_s - max(strike_s for strike_s in strikes if strike_s < release_s)
    assert late_s[30] - late_s[0] == pytest.approx(0.030, abs=0.002)


def test_pushes_are_told_in_the_lever_s_units():
    """At an ankle with the lever of 0.12 m: no moment beyond the spring's, an ankle that flexes on included, and its energy."""
    done = run("--plant", "reflex", "--person", file_of("persons", "reflex-new"), "--device", file_of("devices", "virtual-adult"),
               "--start-r0", 0.02, "--steps", 30, "--json", command="sim")
    assert done.returncode == 0, done.stderr
    for leg in (json.loads(done.stdout)["push"][side] for side in ("left", "right")):
        assert leg["pushes"] > 5 and leg["lever_m"] == pytest.approx(0.12)
        assert 0.6 < leg["peak_torque_Nm"] / (7000 * 0.02 * 0.12) < 1.3  # a tick after the release
        assert 0.5 < leg["work_J"] / (0.5 * 7000 * 0.02 ** 2) < 1.1


@pytest.mark.parametrize("options, words", [
    (("--recording", "x.csv", "--without-device"), "--without-device needs --plant reflex"),
    (("--fault-ms", "10"), "--fault-ms needs --fault NAME"),
    (("--release-late-ms", "60"), "0 to 49"),
    (("--push", "5@3/"), "NEWTONSECONDS@SECONDS/DURATION"),
    (("--push", "5@3/x"), "NEWTONSECONDS@SECONDS/DURATION"),
    (("--push", "5@3/11"), "0 to 10 s"),
])
def test_what_cannot_be_asked_is_refused(options, words):
    refused = run(*options, "--steps", "3")
    assert refused.returncode == 2 and words in refused.stderr


def dose(*arguments):
    return run("dose", "--person", "sim_host/persons/adult70.ini", "--device", "sim_host/devices/virtual-adult.ini",
               *arguments, command="study")


def test_a_dose_is_set_beside_the_walk_without_it(tmp_path):
    """The pair without the device is the walk of `afo sim --without-device`; walks that are kept are not walked again."""
    asked = ("--r0", "0.005", "--late-ms", "0,20", "--steps", "12", "--push-step", "0", "--jobs", "2", "--out", tmp_path / "kept")
    table, picture = tmp_path / "dose.csv", tmp_path / "dose.svg"
    done = dose(*asked, "--csv", table, "--plot", picture)
    assert done.returncode == 0, done.stderr
    said = [line for line in done.stdout.splitlines() if line.startswith(("  r0", "sim_host"))]
    assert len(said) == 3 and all("this model" in line for line in said)
    with table.open(newline="", encoding="utf-8") as file:
        alone, *doses = list(csv.DictReader(file))
    assert alone["device"] == "0" and alone["r0_m"] == "" and float(alone["device_J_m"]) == 0
    assert [(row["r0_m"], row["late_s"]) for row in doses] == [("0.005", "0"), ("0.005", "0.02")]
    assert all(row["fell"] == "0" and row["ankle_J_m"] != alone["ankle_J_m"] for row in doses)
    assert picture.read_text(encoding="utf-8").count("<svg") == 1
    ticks = tmp_path / "ticks.csv"
    told("--steps", "14", f"--ticks={ticks}")
    with ticks.open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if 4.0 < float(row["time_s"]) < 8.0]
    speed_m_s = -(float(rows[-1]["hip_x_m"]) - float(rows[0]["hip_x_m"])) / (float(rows[-1]["time_s"]) - float(rows[0]["time_s"]))
    assert float(alone["speed_m_s"]) == pytest.approx(speed_m_s, rel=0.02)
    again = dose(*asked, "--json")
    assert again.returncode == 0 and "runs by" not in again.stderr
    assert [walk["steps"] for walk in json.loads(again.stdout)["walks"]] == [12, 12, 12]


def test_doses_are_a_table(tmp_path):
    """A line a dose, of the figures in the CSV; without pushes no margin is told."""
    table = tmp_path / "dose.csv"
    done = dose("--r0", "0.005", "--steps", "12", "--push-step", "0", "--csv", table, "--markdown")
    assert done.returncode == 0, done.stderr
    with table.open(newline="", encoding="utf-8") as file:
        alone, with_it = ({name: float(value or "nan") for name, value in row.items() if name != "person"} for row in csv.DictReader(file))
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in done.stdout.splitlines() if line.startswith("| adult70.ini")]
    change = 100 * (with_it["ankle_J_m"] / alone["ankle_J_m"] - 1)
    assert len(rows) == 1 and rows[0][1:4] == ["0.005", "0", "0 (0)"]
    assert rows[0][5] == f"{change:+.1f} ({change:+.1f} to {change:+.1f})"
    assert rows[0][8] == f"{with_it['speed_m_s']:.3f} ({alone['speed_m_s']:.3f})" and rows[0][10] == ""


@pytest.mark.long
def test_a_push_margin_is_the_largest_that_is_survived(tmp_path):
    """By bisection, to its step; 0 where the next larger one is already too much."""
    table = tmp_path / "dose.csv"
    done = dose("--r0", "0.005", "--steps", "12", "--push-step", "20", "--csv", table)
    assert done.returncode == 0
    with table.open(newline="", encoding="utf-8") as file:
        margins = [float(row["push_margin_N"]) for row in csv.DictReader(file)]
    assert margins[0] > 0 and all(margin % 20 == 0 and margin < 400 for margin in margins)
    half = "up to r0 0.005 m" if 2 * margins[1] >= margins[0] else "with no r0 from 0.005 m on"
    assert f"half of its push margin, in every pair, {half}" in done.stdout


@pytest.mark.parametrize("words, told_of", [(("--r0", "0.02,0.01"), "rising numbers"), (("--late-ms", "60"), "0 to 49"),
                                            (("--r0", "0.01,"), "rising numbers"), (("--seeds", "0"), "--seeds")])
def test_a_dose_that_cannot_be_is_refused(words, told_of):
    refused = dose(*words)
    assert refused.returncode == 2 and told_of in refused.stderr


def test_a_dose_needs_a_person():
    refused = run("dose", "--device", "sim_host/devices/virtual-adult.ini", command="study")
    assert refused.returncode == 2 and "--person FILE" in refused.stderr


def points_of(text):
    return [tuple(float(number) for number in point.split(",")) for point in text.split()]


def test_the_person_as_a_picture_that_moves_with_a_strip_below(tmp_path):
    """Thigh and shank keep their length in every frame, some foot is on the ground, and the strip has a figure each 0.1 s."""
    ticks, picture = tmp_path / "ticks.csv", tmp_path / "walk.svg"
    told("--steps", "6", f"--ticks={ticks}")
    done = run(ticks, "--out", picture, command="export")
    assert done.returncode == 0, done.stderr
    svg = "{http://www.w3.org/2000/svg}"
    lines = list(xml.etree.ElementTree.parse(picture).iter(f"{svg}polyline"))
    moving = [line.find(f"{svg}animate").get("values").split(";") for line in lines if len(line)]
    assert len(moving) == 3 and len(lines) - 3 == pytest.approx(3 * 27, abs=6)
    legs = [[points_of(frame) for frame in line] for line in (moving[0], moving[2])]
    for leg in legs:
        assert len(leg) > 50
        for hip, knee, ankle, _, _ in leg:
            assert math.dist(hip, knee) == pytest.approx(110, abs=0.3) and math.dist(knee, ankle) == pytest.approx(110, abs=0.3)
    for left, right in zip(*legs):
        assert max(y for _, y in left[3:] + right[3:]) == pytest.approx(360, abs=8)  # pixels: 237 are a metre


def test_a_table_of_doses_that_cannot_be_written_is_told_before_the_walks(tmp_path):
    done = run("dose", "--person", file_of("persons", "reflex-new"), "--device", file_of("devices", "virtual-adult"),
               "--steps", 10000, "--csv", tmp_path / "nowhere" / "a.csv", command="study")
    assert done.returncode == 2 and not done.stdout and "a.csv: No such file or directory" in done.stderr


@pytest.mark.parametrize("seed", (1, 2))
def test_an_ankle_that_answers_to_pushes_is_not_taken_for_misplaced(seed):
    """With switches that are late: the ankle is extended as the other foot lands, and bent again as its own is seen to leave."""
    done = run("--plant", "reflex", "--person", file_of("persons", "reflex-new"), "--device", file_of("devices", "virtual-adult"),
               "--start-r0", 0.03, "--seed", seed, "--steps", 40, "--json", command="sim")
    told = json.loads(done.stdout)
    assert done.returncode == 0 and not told["fault"], done.stderr
    assert told["push"]["left"]["pushes"] > 5 and told["push"]["right"]["pushes"] > 5
