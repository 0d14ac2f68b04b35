"""afo compare: each law's row is what afo sim says of it, and the picture has a line for each."""
import csv
import json
import re
import xml.etree.ElementTree as ElementTree

import pytest

from afo import ADULT, run

WALK = ("--speed", 0.45, "--steps", 24, "--seed", 2)
SVG = "{http://www.w3.org/2000/svg}"


def compare(*arguments, status=0):
    done = run(*arguments, command="compare")
    assert done.returncode == status, done.stderr
    return done


def by_sim(law, tmp_path, *arguments):
    """The rows of the same walk, by afo sim."""
    path = tmp_path / f"{law}.csv"
    run("--law", law, *arguments, "--csv", path, "--quiet")
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("who,mass_kg,spring_N_m", [((), 1.02, 100.0), (ADULT, None, None)], ids=("paper", "adult"))
def test_a_row_is_what_sim_says(tmp_path, who, mass_kg, spring_N_m):
    told = json.loads(compare("--laws", "proportional,dlqr", "--json", *WALK, *who).stdout)
    assert [one["law"] for one in told] == ["proportional", "dlqr"]
    for one in told:
        rows = by_sim(one["law"], tmp_path, *WALK, *who)
        last = [float(row["apex_speed_rad_s"]) for row in rows[-20:]]
        assert one["steps"] == len(rows) == 24 and one["fault"] is None and not one["fell"]
        assert one["mean_rad_s"] == pytest.approx(sum(last) / 20, abs=1e-8)
        assert (one["least_rad_s"], one["greatest_rad_s"]) == pytest.approx((min(last), max(last)), abs=1e-8)
        whole = rows[-20:-1]  # the last step has no length yet
        r0, way = [float(row["r0_m"]) for row in whole], sum(float(row["step_length_m"]) for row in whole)
        assert one["r0_m"] == pytest.approx(sum(r0) / len(r0), abs=1e-8)
        assert one["speed_m_s"] == pytest.approx(way / (float(rows[-1]["time_s"]) - float(whole[0]["time_s"])), rel=1e-5)
        if mass_kg:
            energy = sum(0.5 * spring_N_m * value ** 2 for value in r0)
            assert one["cost_of_transport"] == pytest.approx(energy / (mass_kg * 9.80665 * way), rel=1e-5)


def test_open_loop_holds_the_steady_push_off_of_the_speed():
    """At 0.40696 rad/s that is the paper's 0.05 m."""
    told = json.loads(compare("--laws", "open-loop", "--json", "--speed", 0.40696, "--steps", 10).stdout)
    assert told[0]["r0_m"] == pytest.approx(0.05, abs=2e-5)


def test_a_fall_is_a_row_and_status_1():
    done = compare("--laws", "proportional,predictive", "--speed", 0.6, "--start-r0", 0.104, "--steps", 30, "--push", "0.1@15", status=1)
    rows = {line.split()[0]: line for line in done.stdout.splitlines() if line.split()[:1] in (["proportional"], ["predictive"])}
    assert "FELL: fallen" in rows["proportional"] and len(rows) == 2


def test_the_picture_has_a_line_a_law(tmp_path):
    picture = tmp_path / "laws.svg"
    compare("--laws", "proportional,dlqr,predictive", "--plot", picture, *WALK)
    tree = ElementTree.parse(picture)
    lines = [path for path in tree.iter(f"{SVG}path") if path.get("class") == "line"]
    names = [text.text for text in tree.iter(f"{SVG}text")]
    assert len(lines) == 6 and {"proportional", "dlqr", "predictive"} <= set(names)
    assert {"Apex speed (rad/s)", "Precompression asked for (m)", "step"} <= set(names)
    assert all(len(re.findall("[ML]", line.get("d"))) == 24 for line in lines[:3])
    width, height = (float(tree.getroot().get(key)) for key in ("width", "height"))
    for line in lines:
        for x, y in re.findall(r"[ML]([\d.]+) ([\d.]+)", line.get("d")):
            assert 0 < float(x) < width and 0 < float(y) < height


@pytest.mark.parametrize("arguments,words", [
    (("--laws", "proportionl"), "nearest: proportional"),
    (("--laws", "dlqr,"), '"" is unknown'),
    (("--laws", "person"), "the law of a recorded person"),
    (("--law", "dlqr"), "the laws are named by --laws"),
    (("--speed", "9"), "out of range: this law serves this walker from"),
    (("--plot", "/nowhere/laws.svg", "--steps", "3"), "/nowhere/laws.svg: No such file"),
    (("--steps", "0"), "--steps"),
    (("extra",), "extra"),
])
def test_what_does_not_fit_is_said(arguments, words):
    assert words in compare(*arguments, status=2).stderr
