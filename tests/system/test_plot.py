"""--plot of every study: a picture of the numbers that the study prints, and words for a file that cannot be."""
import csv
import itertools
import json
import math
import re
import xml.etree.ElementTree as ElementTree

import pytest

from afo import file_of, run
from test_afo import STUDIES

SVG = "{http://www.w3.org/2000/svg}"
PERSON = file_of("persons", "adult70")
# Each study, small, and the panels that its picture has.
SMALL = {
    "fixed-point": (("--r0", 0.05), 2),
    "continue": (("--from", 0.05, "--to", 0.09), 4),
    "doublings": (("--from", 0.05, "--to", 0.1, "--count", 3), 2),
    "bifurcation": (("--from", 0.05, "--to", 0.09, "--points", 12, "--transient", 100, "--keep", 8, "--lyapunov", 10), 5),
    "basin": (("--points", 12), 2),
    "basin --volume": (("--points", 8), 1),
    "gain": (("--points", 20), 4),
    "noise": (("--walkers", 20, "--strides", 50), 3),
    "map": (("--steps", 5), 4),
    "map --samples 20": (("--steps", 2), 2),
    "atlas basin": (("FOLDER/basin", "--points", 12), 3),
    "atlas plane": (("FOLDER/plane", "--points", 12), 1),
    "laws jumps": (("--law", "dlqr"), 1),
    "laws basin": (("--samples", 50, "--law", "dlqr"), 2),
    "laws sensitivity": (("--law", "dlqr"), 2),
    "laws slope": ((), 3),
    "laws mismatch": (("--law", "dlqr"), 3),
    "laws energy": (("--law", "dlqr"), 3),
    "laws timing": (("--samples", 10), 4),
    "observer-gains": ((), 2),
    "tune-person": (("--person", PERSON, "--out", "FOLDER/person.ini", "--generations", 2, "--walks", 1, "--seconds", 5), 1),
    "validate-person": (("--person", PERSON, "--steps", 12, "--seeds", 1), 2),
    "table": ((), 1),
    "dose": (("--person", file_of("persons", "reflex-new"), "--device", file_of("devices", "virtual-adult"), "--r0", "0.01,0.02",
              "--steps", 8, "--push-step", 0), 5),
}
LONG = {
    "observe": (("--steps", 10), 4),
    "latch": (("--law", "dlqr", "--steps", 10, "--trials", 1), 4),
    "laws limits": (("--samples", 100), 1),
    "laws ground": (("--samples", 2), 4),
    "laws ground-limit": (("--samples", 2), 1),
    "laws push": (("--law", "dlqr"), 4),
    "observe --mismatch": (("--steps", 10), 2),
}
CASES = [*(pytest.param(*case, id=case[0]) for case in SMALL.items()),
         *(pytest.param(*case, id=case[0], marks=pytest.mark.long) for case in LONG.items())]


def study(*words, status=0):
    done = run(*words, command="study")
    assert done.returncode == status, done.stderr
    return done


def marks(picture, kind):
    return [mark for mark in ElementTree.parse(picture).iter() if mark.get("class") == kind]


def points(mark):
    return [tuple(map(float, pair)) for pair in re.findall(r"[ML]([-\d.]+) ([-\d.]+)", mark.get("d"))]


def is_straight(pixels, numbers):
    """Whether pixels are a line of the numbers: an axis, whatever its ends are."""
    low, high = (numbers.index(end(numbers)) for end in (min, max))
    scale = (pixels[high] - pixels[low]) / (numbers[high] - numbers[low])
    return all(abs(pixels[low] + scale * (number - numbers[low]) - pixel) < 0.11 for pixel, number in zip(pixels, numbers))


DRAWN = [name for name in STUDIES if name != "page"]  # it is pictures


def test_every_study_is_tried():
    assert {name.split()[0] for name in (*SMALL, *LONG)} == set(DRAWN)


@pytest.mark.parametrize("name,how", CASES)
def test_a_study_draws(name, how, tmp_path):
    (options, panels), picture = how, tmp_path / "it.svg"
    study(*name.split(), *(str(word).replace("FOLDER", str(tmp_path)) for word in options), "--plot", picture)
    tree = ElementTree.parse(picture).getroot()
    width, height = (float(tree.get(key)) for key in ("width", "height"))
    assert len(marks(picture, "frame")) == panels
    assert any(marks(picture, kind) for kind in ("line", "dots", "cell", "bar"))
    assert "nan" not in picture.read_text(encoding="utf-8") and "inf" not in picture.read_text(encoding="utf-8")
    assert tree.find(f"{SVG}title").text.startswith(f"afo study {name.split()[0]}")
    for mark in itertools.chain(marks(picture, "line"), marks(picture, "dots"), marks(picture, "cell")):
        assert all(0 < x < width and 0 < y < height for x, y in points(mark))


def test_a_picture_is_of_the_numbers(tmp_path):
    """The lines of `gain` are straight images of the table's columns, gain by gain."""
    picture, table = tmp_path / "gain.svg", tmp_path / "gain.csv"
    study("gain", "--kp", "0,0.042", "--points", 15, "--csv", "--out", table, "--plot", picture)
    with open(table, newline="", encoding="ascii") as file:
        rows = list(csv.DictReader(file))
    for line, kp in zip(marks(picture, "line"), (0.0, 0.042)):
        mine = [row for row in rows if float(row["kp"]) == kp]
        x, y = zip(*points(line))
        assert len(x) == 15
        assert is_straight(x, [float(row["r0_m"]) for row in mine])
        assert is_straight(y, [float(row["largest"]) for row in mine])


def test_the_cells_of_a_basin_are_its_outcomes(tmp_path):
    picture = tmp_path / "basin.svg"
    told = json.loads(study("basin", "--points", 9, "--json", "--plot", picture).stdout)
    colours = [mark.get("fill") for mark in marks(picture, "cell")][:81]
    outcomes = [row["outcome"] for row in told["rows"]]
    assert len(set(zip(colours, outcomes))) == len(set(outcomes)) == len(set(colours)) > 1


def test_a_gait_closes(tmp_path):
    """The portrait of a gait of period 1: the leg that swung goes on where the other one began."""
    picture = tmp_path / "gait.svg"
    study("fixed-point", "--r0", 0.05, "--plot", picture)
    first, second = (points(line) for line in marks(picture, "line")[:2])
    assert math.dist(first[-1], second[0]) < 0.5 and math.dist(second[-1], first[0]) < 0.5


def test_a_resumed_run_draws_the_rows_it_had(tmp_path):
    table, pictures = tmp_path / "it.csv", [tmp_path / f"{name}.svg" for name in ("whole", "resumed")]
    words = ("bifurcation", "--from", 0.05, "--to", 0.09, "--points", 8, "--transient", 50, "--keep", 4, "--csv", "--out", table)
    study(*words, "--plot", pictures[0])
    lines = table.read_text(encoding="ascii").splitlines(keepends=True)
    table.write_text("".join(lines[:15]), encoding="ascii")
    study(*words, "--resume", "--plot", pictures[1])
    whole, resumed = (marks(picture, "dots") for picture in pictures)
    assert [mark.get("d") for mark in whole] == [mark.get("d") for mark in resumed]


def test_a_picture_that_is_cut_says_so(tmp_path):
    """A picture takes 16 panels; `gain` has one for all gains, and one for each."""
    for gains in (15, 16):
        words = ",".join(f"{0.001 * i:.3f}" for i in range(gains))
        done = study("gain", "--kp", words, "--points", 3, "--plot", tmp_path / "it.svg")
        assert ("more was found than is drawn" in done.stderr) == (gains == 16)
        assert len(marks(tmp_path / "it.svg", "frame")) == 16


@pytest.mark.parametrize("name", DRAWN)
def test_a_file_that_cannot_be_is_said_before_the_study_runs(name, tmp_path):
    for picture, words in (("walk.png", "the picture is an SVG; give it a name that ends in .svg"),
                           (tmp_path / "nowhere" / "it.svg", "it.svg: No such file or directory")):
        done = study(name, "--plot", picture, status=2)
        assert words in done.stderr and not done.stdout
    assert "--plot=FILE.svg" in study(name, "--help").stdout


def test_no_picture_is_left_of_nothing(tmp_path):
    """Of a walker without a gait, and of all studies of the laws at once."""
    for words, status in ((("fixed-point", "--r0", 0.05, "--k", 0.1), 1), (("laws", "all"), 2)):
        study(*words, "--plot", tmp_path / "it.svg", status=status)
        assert not list(tmp_path.iterdir())
