"""Scripts that read tables say in words what is wrong with one, and end with exit status 2."""
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

STEPS = "step,apex_speed_rad_s,target_speed_rad_s,r0_m\n" + "".join(f"{i},0.4,0.8,0.05\n" for i in range(1, 5))
TICK_COLUMNS = ("time_s,stance,phase,theta_left_rad,theta_right_rad,rate_left_rad_s,ankle_left_m,ankle_right_m,"
                "motor_left_m,motor_right_m,supervisor,hip_x_m,hip_y_m")
TICKS = TICK_COLUMNS + "\n" + "".join(f"{0.001 * i},left,single,0,0,0,0,0,0,0,walking,0,1\n" for i in range(50))
OBSERVE_COLUMNS = ("sensor,noise_counts,latency_s,speed_rad_s,fell_after,observer_rms,plain_rms,butterworth_rms,"
                   "observer_spread,observer_falls,plain_spread,plain_falls,butterworth_spread,butterworth_falls")
OBSERVE = OBSERVE_COLUMNS + "\n" + "".join(
    f"{bits} bit,{noise},0.002,0.8,0,0.01,0.1,0.1,0.1,,,2,,5\n" for bits in (12, 14, 17) for noise in (0.25, 1, 2))
JUMPS = "law,from_rad_s,to_rad_s,fell,settled,steps\ndlqr,0.2,0.3,0,1,7\n"
LAWS = {
    "jumps": JUMPS, "jumps-chain": JUMPS,
    "basin": "law,speed_rad_s,samples,reached,viability_inner,viability_outer\ndlqr,0.4,100,12,60,66\n",
    "ground": "law,kind,speed_rad_s,size_mm,steps,falls\ndlqr,heights,0.4,10,500,200\n",
    "ground-chain": "law,kind,speed_rad_s,size_mm,steps,falls\ndlqr,heights,0.4,10,500,200\n",
    "push-chain": "law,speed_rad_s,direction,phase,share_of_m_sqrt_gl\ndlqr,0.4,forward,0.1,0.02\n",
    "sensitivity": "law,speed_rad_s,step_time_s_per_leg\ndlqr,0.4,17.9\n",
    "slope": "law,case,speed_rad_s,fell,speed_share,energy_J_per_m\ndlqr,+0.0 deg,0.8,0,1,1\n",
    "mismatch": "law,case,speed_rad_s,fell,speed_share,energy_J_per_m\ndlqr,M -10 %,0.6,0,1,1\n",
    "energy": "law,case,speed_rad_s,fell,speed_share,energy_J_per_m\ndlqr,noise 0.0 %,0.4,0,1,0.2\n",
    "timing": "speed_rad_s,release_s,cost_of_transport,eigenvalue\n0.4,0,0.1,0.8\n",
}
LOG = "(0.000000) sim 080#\n"

# Each script: the files it reads when all is well, its arguments, and the one that a test spoils.
CASES = {
    "plot-fault": ({"ticks.csv": TICKS}, ["ticks.csv", "out.png"], "ticks.csv"),
    "plot-observe": ({"observe.csv": OBSERVE}, ["observe.csv", "--out", "out"], "observe.csv"),
    "plot-walk steps": ({"law.csv": STEPS, "ticks.csv": TICKS},
                        ["--law", "law.csv", "--ticks", "ticks.csv", "--out", "out"], "law.csv"),
    "plot-walk held": ({"law.csv": STEPS, "held.csv": STEPS, "ticks.csv": TICKS},
                       ["--law", "law.csv", "--held", "held.csv", "--ticks", "ticks.csv", "--out", "out"], "held.csv"),
    "plot-walk ticks": ({"law.csv": STEPS, "ticks.csv": TICKS},
                        ["--law", "law.csv", "--ticks", "ticks.csv", "--out", "out"], "ticks.csv"),
    "plot-laws": ({f"laws/laws-{study}.csv": text for study, text in LAWS.items()}, ["laws", "--out", "out"],
                  "laws/laws-jumps.csv"),
    "laws-table": ({f"laws/laws-{study}.csv": text for study, text in LAWS.items()}, ["laws"],
                   "laws/laws-energy.csv"),
}
BINARY = bytes(range(256)) * 20
SPOILT = {
    "empty": b"", "header alone": None, "binary": BINARY, "no table": b"This is a letter.\n\nNot a table.\n",
    "text for a number": None, "a short row": None,
}


def spoil(kind, text):
    """The table with that wrong with it."""
    lines = text.splitlines()
    if kind == "header alone":
        return (lines[0] + "\n").encode()
    if kind == "text for a number":
        return (lines[0] + "\n" + ",".join("x" for _ in lines[0].split(",")) + "\n").encode()
    if kind == "a short row":
        return ("\n".join([*lines, lines[-1].rsplit(",", 3)[0]]) + "\n").encode()
    return SPOILT[kind]


def prepare(folder, case):
    files, arguments, name = CASES[case]
    for path, text in files.items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_text(text)
    (folder / "out").mkdir(exist_ok=True)
    return [ROOT / "scripts" / case.split()[0], *arguments], folder / name


def told(folder, command, name):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    last = done.stderr.splitlines()[-1]
    assert last.startswith(f"{command[0].name}: ") and name in last, done.stderr
    return last


@pytest.mark.parametrize("case", CASES)
def test_the_unspoilt_tables_are_taken(case, tmp_path):
    command, _ = prepare(tmp_path, case)
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("case", [case for case in CASES if case != "plot-laws"])
def test_a_missing_file(case, tmp_path):
    command, path = prepare(tmp_path, case)
    path.unlink()
    assert "no such file" in told(tmp_path, command, path.name).lower()


@pytest.mark.parametrize("case", CASES)
def test_a_folder_for_a_file(case, tmp_path):
    command, path = prepare(tmp_path, case)
    path.unlink()
    path.mkdir()
    assert "directory" in told(tmp_path, command, path.name).lower()


# All read through one function: every kind with the quick ones, which draw nothing before they read.
@pytest.mark.parametrize("case,kind", [(case, kind) for case in CASES for kind in SPOILT
                                       if case in ("plot-fault", "laws-table") or kind in ("empty", "no table")])
def test_what_is_no_table(case, kind, tmp_path):
    command, path = prepare(tmp_path, case)
    path.write_bytes(spoil(kind, path.read_text()))
    told(tmp_path, command, path.name)


@pytest.mark.parametrize("case", CASES)
def test_a_missing_column_is_named(case, tmp_path):
    command, path = prepare(tmp_path, case)
    rows = [line.split(",") for line in path.read_text().splitlines()]
    for i in (0, rows[0].index("supervisor") if case == "plot-fault" else len(rows[0]) - 2):
        path.write_text("".join(",".join(row[:i] + row[i + 1:]) + "\n" for row in rows))
        assert rows[0][i] in told(tmp_path, command, path.name)


def test_no_table_of_the_laws_at_all(tmp_path):
    (tmp_path / "laws").mkdir()
    for script in ("plot-laws", "laws-table"):
        told(tmp_path, [ROOT / "scripts" / script, "laws"], "laws")
        told(tmp_path, [ROOT / "scripts" / script, "nowhere"], "nowhere")


def test_a_study_of_the_laws_without_rows_is_left_out(tmp_path):
    command, path = prepare(tmp_path, "plot-laws")
    path.write_text(JUMPS.splitlines()[0] + "\n")
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and "laws-jumps.csv" in done.stderr
    assert not (tmp_path / "out" / "laws-jumps.png").exists() and (tmp_path / "out" / "laws-basin.png").exists()


@pytest.mark.parametrize("case", ["plot-fault", "plot-observe", "plot-walk steps", "plot-laws"])
def test_a_picture_that_cannot_be_written(case, tmp_path):
    command, _ = prepare(tmp_path, case)
    (tmp_path / "out").rmdir()
    (tmp_path / "out").write_text("a file where a folder should be")
    command = [word if word != "out.png" else "out/out.png" for word in command]
    told(tmp_path, command, "out")


@pytest.mark.parametrize("content", [b"", BINARY, b"(0.0) sim 080\n", None, b"x" * 100])
def test_compare_walks_needs_two_logs(content, tmp_path):
    (tmp_path / "good.log").write_text(LOG * 3)
    if content is not None:
        (tmp_path / "bad.log").write_bytes(content)
    told(tmp_path, [ROOT / "scripts" / "compare-walks", "good.log", "bad.log"], "log")


@pytest.mark.parametrize("content", [None, b"no program\n", b"#!/bin/sh\necho rubbish\n", b"#!/bin/sh\nexit 1\n"])
def test_paper_needs_the_program(content, tmp_path):
    if content is not None:
        (tmp_path / "afo").write_bytes(content)
        (tmp_path / "afo").chmod(0o755)
    assert "./afo" in told(tmp_path, [ROOT / "scripts" / "paper", "--afo", "./afo", "--out", "paper"], "afo")
