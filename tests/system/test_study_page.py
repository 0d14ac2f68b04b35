"""afo study page: the paper's tables and figures for any walker."""
import csv
import json
import math
import re

import pytest

from afo import ADULT, run


def page(*arguments, status=0):
    done = run("page", *arguments, command="study")
    assert done.returncode == status, done.stderr
    return done


def cell(text, name):
    return float(re.search(rf"<td>{re.escape(name)}</td><td>([-\d.e]+)</td>", text).group(1))


@pytest.mark.long
def test_a_scaled_walker_has_the_papers_page(tmp_path):
    """A walker that is the paper's in other units of mass and length: every number is the paper's in these."""
    length, mass, gravity = 0.9, 70.0, 9.80665
    page("--M", mass, "--m", 0.01 * mass, "--l", length, "--k", 100.0 * mass / length, "--quick", "--out", tmp_path)
    text = (tmp_path / "index.html").read_text(encoding="utf-8")
    rate = math.sqrt(1.0 / length)
    assert cell(text, "stance rate (rad/s)") == pytest.approx(-0.4069 * rate, abs=1e-4)
    assert cell(text, "swing angle (rad)") == pytest.approx(-0.0596, abs=1e-4)
    assert cell(text, "swing rate (rad/s)") == pytest.approx(1.7568 * rate, abs=1e-4)
    assert cell(text, "eigenvalue 1") == pytest.approx(-0.5715, abs=1e-4)
    with open(tmp_path / "data/table1.csv", newline="", encoding="ascii") as file:
        first = [float(row["r0_m"]) / length for row in csv.DictReader(file)]
    assert first == pytest.approx([0.06573, 0.08486, 0.08927], abs=1e-5)
    best = float(re.search(r"makes it smallest is ([\d.]+)", text).group(1))
    own = json.loads(run("gain", "--best", "--json", command="study").stdout)["best_kp"]
    assert best == pytest.approx(own * length / rate, rel=1e-3)
    assert text.count("<figure>") == 9 and "is not here" not in text


@pytest.mark.long
def test_an_adult_with_a_device_has_a_page(tmp_path):
    page(*ADULT, "--quick", "--out", tmp_path)
    text = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "M = 65 kg, m = 2.5 kg, l = 0.93 m, k = 7000 N/m" in text
    for name in re.findall(r"src=(\S+)", text):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("arguments,status,words", [
    (("--person", "nobody.ini"), 2, "nobody.ini"),
    (("--out", "/proc/page"), 2, "--out /proc/page: "),
    (("--l", "-1"), 2, "--l: -1 is out of range"),
    (("--k", "1", "--out", "FOLDER"), 1, "no steady gait at r0 = 0.05 m"),
])
def test_what_does_not_fit_is_said(arguments, status, words, tmp_path):
    done = page(*(word.replace("FOLDER", str(tmp_path)) for word in arguments), "--quick", status=status)
    assert words in done.stderr and not (tmp_path / "index.html").exists()
