"""build/afo study as its users see it: reference values, formats, threads, resuming, messages.

Reference values: the paper's, with the digits of the re-derived model where it has more."""
import csv
import io
import json
import math
import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[4]
PROGRAM = ROOT / os.environ.get("BUILD", "build") / "afo"
ADULT = ("--M", "65", "--m", "2.5", "--l", "0.93", "--k", "7000")
HEAVY_LEGS = ("--m", "0.2")


def run(*arguments, status=0):
    done = subprocess.run([PROGRAM, "study", *map(str, arguments)], capture_output=True, text=True, timeout=600,
                          check=False)
    assert done.returncode == status, done.stderr
    return done


def ask(*arguments, status=0):
    return json.loads(run(*arguments, "--json", status=status).stdout)


def rows(*arguments, status=0):
    text = run(*arguments, "--csv", status=status).stdout
    return list(csv.DictReader(io.StringIO(text)))


def magnitude(pair):
    return math.hypot(*pair)


def test_the_papers_gait_and_eigenvalues():
    gait = ask("fixed-point", "--r0", 0.05)
    assert gait["x"] == pytest.approx([-0.406960, -0.059569, 1.756768], abs=1e-6)
    values = gait["eigenvalues"]
    assert [v[0] for v in values] == pytest.approx([-0.57144, -0.11020, 0.0], abs=1e-5)
    assert abs(values[2][0]) < 1e-9 and all(v[1] == 0 for v in values)
    assert gait["smallest_eigenvector"] == pytest.approx([0.0031, 0.4389, 0.8985], abs=1e-4)
    assert gait["residual"] < 1e-12 and gait["period"] == 1 and gait["stable"] is True
    assert gait["speed_m_s"] == pytest.approx(gait["step_length_m"] / sum(gait["times_s"]), rel=1e-12)
    assert gait["step_length_m"] == pytest.approx(2 * math.sin(gait["inter_leg_rad"] / 2), rel=1e-12)
    # Energy per step is what the spring gives: k r0^2 / 2.
    energy = 0.5 * 100 * 0.05 ** 2
    assert gait["cost_of_transport"] == pytest.approx(energy / (1.02 * 9.80665 * gait["step_length_m"]),
                                                      rel=1e-12)


@pytest.mark.parametrize("arguments", [("observer-gains",), ("fixed-point", "--r0", "0.05"),
                                       ("map", "--r0", "0.05", "--strides", "3")])
def test_a_full_disk_is_noticed(arguments):
    """/dev/full takes the open and refuses the write."""
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run([PROGRAM, "study", *arguments], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60,
                              check=False)
    assert done.returncode not in (0, 1), done.stderr
    assert done.stderr != ""


def test_the_short_branch_and_a_doubled_gait():
    short = ask("fixed-point", "--r0", 0.05, "--branch", "short")
    assert short["x"] == pytest.approx([-0.521217, -0.205854, 1.416979], abs=1e-6)
    assert short["stable"] is False
    assert sum(short["times_s"]) < sum(ask("fixed-point", "--r0", 0.05)["times_s"])
    double = ask("fixed-point", "--r0", 0.08, "--period", 2)
    assert double["stable"] is True and len(double["rows"]) == 2 and double["residual"] < 1e-12
    a, b = (r["step_length_m"] for r in double["rows"])
    assert abs(a - b) > 0.02


def test_the_law_leaves_the_gait_and_moves_its_eigenvalues():
    free, held = ask("fixed-point", "--r0", 0.2), ask("fixed-point", "--r0", 0.2, "--kp", 0.042)
    assert held["x"] == pytest.approx(free["x"], abs=1e-11)
    assert magnitude(free["eigenvalues"][0]) > 2 and magnitude(held["eigenvalues"][0]) < 0.88
    # The other sign is the paper's print with a negative speed: it destabilises.
    assert magnitude(ask("fixed-point", "--r0", 0.2, "--kp", -0.042)["eigenvalues"][0]) > 2.5


def test_first_doublings_both_ways():
    up = [float(r["r0_m"]) for r in rows("doublings", "--from", 0.05, "--to", 0.1, "--count", 3)]
    assert up == pytest.approx([0.0657282, 0.0848527, 0.0892606], abs=1e-6)
    down = [float(r["r0_m"]) for r in rows("doublings", "--from", 0.3, "--to", 0.23, "--count", 3)]
    assert down == pytest.approx([0.2610794, 0.2446450, 0.2406227], abs=1e-6)


@pytest.mark.parametrize("walker", [(), ADULT, HEAVY_LEGS], ids=["paper", "adult", "heavy legs"])
@pytest.mark.parametrize("branch", ["long", "short"])
def test_branches_over_the_whole_range(walker, branch):
    length = 0.93 if walker is ADULT else 1.0
    low = 0.012 if walker is HEAVY_LEGS and branch == "short" else 0.005
    found = rows("continue", *walker, "--branch", branch, "--from", 0.3 * length, "--to", low * length,
                 "--step", 0.05)
    r0 = [float(r["parameter"]) / length for r in found]
    assert r0[0] == pytest.approx(0.3) and r0[-1] == pytest.approx(low)
    for r in found:
        smallest = math.hypot(float(r["re3"]), float(r["im3"]))
        assert smallest < 1e-9, r
        if int(r["clamped_strides"]) > 0:
            assert math.hypot(float(r["re2"]), float(r["im2"])) < 1e-9, r
        if branch == "short" and not walker:
            assert r["stable"] == "false" or r["event"]


def test_a_fold_joins_the_two_branches():
    """A stiff ankle's curve turns back: the long branch goes over into the short one."""
    stiff = ("--k", 300)
    found = rows("continue", *stiff, "--from", 0.05, "--to", 0.28)
    folds = [r for r in found if r["event"] == "fold"]
    assert len(folds) == 1 and 0.2 < float(folds[0]["parameter"]) < 0.21
    assert min(abs(float(folds[0][f"re{k}"]) - 1) for k in (1, 2, 3)) < 1e-7
    assert float(found[-1]["parameter"]) == pytest.approx(0.05)
    short = ask("fixed-point", *stiff, "--branch", "short")
    assert float(found[-1]["stance_rate_rad_s"]) == pytest.approx(short["x"][0], abs=1e-9)


def test_continuation_in_other_parameters_ends_on_the_gait():
    for over, value, flags in (("k", 150.0, ("--k", 150)), ("m", 0.1, ("--m", 0.1)), ("l", 0.8, ("--l", 0.8)),
                               ("M", 1.4, ("--M", 1.4)), ("g", 3.7, ("--g", 3.7))):
        start = {"k": 100, "m": 0.01, "l": 1, "M": 1, "g": 9.80665}[over]
        last = rows("continue", "--over", over, "--from", start, "--to", value)[-1]
        direct = ask("fixed-point", *flags)
        assert float(last["stance_rate_rad_s"]) == pytest.approx(direct["x"][0], abs=1e-10)
        assert float(last["re1"]) == pytest.approx(direct["eigenvalues"][0][0], abs=1e-8)


def test_continuation_in_the_gain():
    last = rows("continue", "--over", "kp", "--from", 0, "--to", 0.042, "--r0", 0.15)[-1]
    direct = ask("fixed-point", "--r0", 0.15, "--kp", 0.042)
    assert [float(last["re1"]), abs(float(last["im1"]))] == pytest.approx(
        [direct["eigenvalues"][0][0], abs(direct["eigenvalues"][0][1])], abs=1e-9)


def test_gain_stabilises_the_whole_range():
    found = [float(r["largest"]) for r in rows("gain", "--kp", 0.042)]
    assert max(found) < 0.88 and min(found) > 0.51
    weak = {float(r["r0_m"]): float(r["largest"]) for r in rows("gain", "--kp", 0.02, "--points", 221)}
    above = [r0 for r0, v in weak.items() if v > 1]
    assert min(above) == pytest.approx(0.09, abs=0.003) and max(above) == pytest.approx(0.225, abs=0.006)
    best = ask("gain", "--best")
    assert best["largest_with_best_kp"] <= max(found) and 0.03 < best["best_kp"] < 0.05
    adult = ask("gain", "--best", *ADULT)
    assert adult["largest_with_best_kp"] < 0.9


def test_a_walker_that_no_gain_stabilises_is_told():
    """k = 30 N/m: at every gain up to 0.2 some gait up to 0.2 m has an eigenvalue beyond 1, by gain's own rows."""
    soft = ("--k", 30, "--to", 0.2, "--points", 12)
    done = run("gain", "--best", *soft, status=1)
    for word in ("no gain of eq. (16) stabilises this walker from r0 = 0.05 to 0.2 m", "up to 0.2 m per rad/s", "--to",
                 "--law dlqr"):
        assert word in done.stderr
    best = ask("gain", "--best", *soft, status=1)
    worst = max(rows("gain", "--kp", best["best_kp"], *soft), key=lambda row: float(row["largest"]))
    assert best["stable_with_best_kp"] is False
    assert f"leaves an eigenvalue of {float(worst['largest']):.3g} at r0 = {float(worst['r0_m']):g} m" in done.stderr
    gains = [0.02 * i for i in range(11)]
    rows_of = {kp: [float(row["largest"]) for row in rows("gain", "--kp", kp, *soft)] for kp in gains}
    assert all(max(largest) > 1 for largest in rows_of.values())


def test_a_best_gain_that_stabilises_says_so():
    assert ask("gain", "--best", "--points", 12)["stable_with_best_kp"] is True


def test_long_runs_know_periods_chaos_and_falls():
    options = ("--points", 2, "--transient", 600, "--keep", 40, "--lyapunov", 200)
    found = {}
    for low, high in ((0.05, 0.08), (0.087, 0.096), (0.12, 0.28)):
        for r in rows("bifurcation", "--from", low, "--to", high, *options):
            found[round(float(r["r0_m"]), 4)] = (int(r["period"]), float(r["lyapunov"]))
    assert [found[r][0] for r in (0.05, 0.08, 0.087, 0.096, 0.12, 0.28)] == [1, 2, 4, 0, -1, 1]
    # The exponent of a gait is the logarithm of its largest eigenvalue.
    gait = ask("fixed-point", "--r0", 0.05)
    assert found[0.05][1] == pytest.approx(math.log(abs(gait["eigenvalues"][0][0])), abs=0.01)
    assert found[0.096][1] > 0.05 and math.isnan(found[0.12][1])


def test_results_do_not_depend_on_the_number_of_threads():
    for command in (("bifurcation", "--points", 150, "--transient", 40, "--keep", 5, "--lyapunov", 10),
                    ("basin", "--points", 15, "--strides", 30),
                    ("basin", "--volume", "--points", 8, "--strides", 20),
                    ("noise", "--walkers", 300, "--strides", 30)):
        one, four = (run(*command, "--csv", "--threads", n).stdout for n in (1, 4))
        assert one == four and len(one) > 200


@pytest.mark.parametrize("command", [("bifurcation", "--points", 70, "--transient", 30, "--keep", 5),
                                     ("basin", "--points", 9, "--strides", 20),
                                     ("basin", "--volume", "--points", 7, "--strides", 9)], ids=lambda c: c[1])
def test_an_interrupted_run_is_resumed_to_the_same_file(tmp_path, command):
    whole, part = tmp_path / "whole.csv", tmp_path / "part.csv"
    run(*command, "--csv", "--out", whole)
    text = whole.read_text()
    for cut in (0, 30, text.index("\n") + 5, len(text) // 3, len(text) - 7, len(text)):
        part.write_text(text[:cut])
        run(*command, "--csv", "--out", part, "--resume")
        assert part.read_text() == text
    other = run(*command, "--csv", "--out", part, "--resume", "--m", 0.02, status=2)
    assert "another run" in other.stderr and part.read_text() == text


def test_the_basin_holds_the_gait_and_not_the_fall():
    found = rows("basin", "--points", 21, "--plane", "stance-rate,swing-angle", "--a-range=-0.9,-0.1",
                 "--b-range=-0.3,0.2")
    outcome = {(round(float(r["a"]), 3), round(float(r["b"]), 3)): int(r["outcome"]) for r in found}
    assert outcome[-0.42, -0.05] == 1 and outcome[-0.1, 0.2] == 0
    volume = ask("basin", "--volume", "--points", 12)
    assert 0 < volume["share"] < 0.5 and volume["volume_rad3_s2"] > 0


def test_what_an_error_of_the_measured_speed_costs_the_law():
    """Known of eq. (16) at 0.8 rad/s: 0.3 % RMS is survived, 1 % falls within about 30 steps."""
    small, large = rows("noise", "--r0", 0.1716, "--error", "0.003,0.01", "--walkers", 200)
    assert int(small["fell"]) == 0 and 0.005 < float(small["speed_spread"]) < 0.05
    assert int(large["fell"]) == 200 and 10 < float(large["strides_to_fall"]) < 60


def test_the_map_tells_each_apex_and_the_fault():
    walk = rows("map", "--r0", 0.11, "--steps", 200, status=1)
    # The state it starts from is the (unstable) gait to rounding; it leaves it and falls.
    assert walk[-1]["fault"] != "none" and all(r["fault"] == "none" for r in walk[:-1])
    assert run("map", "--r0", 0.11, "--steps", 200, status=1).stdout.splitlines()[-1].startswith("fault: ")



@pytest.mark.parametrize("arguments, word", [
    (("fixed-point", "--l=-1"), "leg length"),
    (("fixed-point", "--m", 5), "leg mass"),
    (("fixed-point", "--r0", 0), "r0"),
    (("fixed-point", "--r0", "abc"), "not a number"),
    (("fixed-point", "--period", 0), "whole number"),
    (("fixed-point", "--branch", "middle"), "neither long nor short"),
    (("continue", "--over", "q", "--from", 1, "--to", 2), "none of"),
    (("continue", "--from", 0.1), "must both be given"),
    (("bifurcation", "--from", 0.3, "--to", 0.1), "rise"),
    (("basin", "--plane", "r0,r0"), "differ"),
    (("noise", "--error", "2"), "shares"),
    (("noise", "--walkers", 0), "whole number"),
    (("gain", "--kp", "1,2,x"), "list of 3 numbers"),
    (("gain", "--from=-1"), "rise"),
    (("fixed-point", "--out", "/nonexistent/folder/file"), "cannot write"),
    (("fixed-point", "--resume"), "--resume needs"),
    (("fixed-point", "extra"), "unexpected argument"),
    (("no-such-study",), "no study"),
    (("fixd-point",), "nearest: fixed-point"),
    ((), "Usage"),
])
def test_bad_input_is_told_and_refused(arguments, word):
    done = run(*arguments, status=2)
    assert word in done.stderr and done.stdout == ""


def test_what_is_not_found_is_told_with_what_to_try():
    lost = run("fixed-point", "--r0", 0.25, "--k", 300, status=1)
    assert "lost near r0" in lost.stderr and "try" in lost.stderr and lost.stdout == ""
    none = run("fixed-point", "--r0", 0.05, "--period", 3, status=1)
    assert "period 3" in none.stderr
    fallen = run("fixed-point", "--guess=-5,0,0", status=1)
    assert "step 1" in fallen.stderr
    end = run("continue", "--m", 0.2, "--from", 0.05, "--to", 0.002, status=1)
    assert "could not be followed further, at r0 = 0.004" in end.stderr
    assert "lift-off past the apex" in end.stderr and "smaller --step" in end.stderr


def test_help_and_version():
    assert "fixed-point" in run("--help").stdout
    assert "--branch" in run("fixed-point", "--help").stdout
    assert run("--version").stdout.startswith("afo study ")


@pytest.mark.long
def test_the_whole_cascades_to_period_128():
    up = rows("doublings", "--from", 0.05, "--to", 0.1, "--count", 7)
    assert [float(r["r0_m"]) for r in up[:5]] == pytest.approx(
        [0.0657282, 0.0848527, 0.0892606, 0.0902292, 0.0904381], abs=1e-6)
    down = rows("doublings", "--from", 0.3, "--to", 0.23, "--count", 7)
    # Of the deeper ones the paper's own digits; what is between them is confirmed by walking, below.
    assert [float(r["r0_m"]) for r in down[:5]] == pytest.approx(
        [0.26108, 0.24464, 0.240624, 0.239728, 0.239534], abs=5e-6)
    for cascade in (up, down):
        assert [int(r["new_period"]) for r in cascade] == [2, 4, 8, 16, 32, 64, 128]
        assert float(cascade[-1]["ratio"]) == pytest.approx(4.669, abs=0.003)


@pytest.mark.long
@pytest.mark.parametrize("edge, period", [(0.2397263920, 8), (0.2395325742, 16)])
def test_deep_doublings_are_where_long_walks_double(edge, period):
    """By walking alone, without derivatives: a little above the edge the walk repeats, below it alternates."""
    for offset, wanted in ((4e-6, period), (-4e-6, 2 * period)):
        found = rows("bifurcation", "--from", edge + offset, "--to", edge + offset + 1e-9, "--points", 2,
                     "--transient", 40000, "--keep", 200)
        assert {int(r["period"]) for r in found} == {wanted}


@pytest.mark.long
def test_the_paper_is_reproduced(tmp_path):
    script = ROOT / "scripts" / "paper"
    subprocess.run([script, "--afo", PROGRAM, "--out", tmp_path, "--quick"], check=True, timeout=1200,
                   cwd=ROOT)
    page = (tmp_path / "index.html").read_text()
    for figure in range(4, 13):
        name = f"figure{figure:02d}.png"
        assert name in page and (tmp_path / name).stat().st_size > 10000
    assert "0.0657282" in page and "eq. (11)" in page and "nan" not in page.lower().replace("finance", "")
