"""Runs `build/afo study` for everything that the figures and tables of the paper show, and reads the results."""
import csv
import json
import math
import pathlib
import subprocess

from tables import TableError


class Study:
    """`afo study`, and a folder for what it printed. Files are made anew on every run."""

    def __init__(self, program, folder):
        self.program = str(program)
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)

    def rows(self, name, *arguments, may_fail=False):
        """Runs a command with --csv; its rows as dictionaries, numbers where they are numbers."""
        path = self.folder / f"{name}.csv"
        command = [self.program, "study", *map(str, arguments), "--csv", "--out", str(path), "--quiet"]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        if done.returncode != 0 and not may_fail:
            raise TableError(f"{' '.join(command)}: exit status {done.returncode} {done.stderr}".strip())
        with open(path, encoding="ascii", newline="") as file:
            return [{key: number(value) for key, value in row.items()} for row in csv.DictReader(file)]

    def report(self, *arguments):
        """Runs a command with --json."""
        command = [self.program, "study", *map(str, arguments), "--json", "--quiet"]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        if done.returncode != 0:
            raise TableError(f"{' '.join(command)}: exit status {done.returncode} {done.stderr}".strip())
        return json.loads(done.stdout)


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def column(rows, name):
    return [row[name] for row in rows]


def gather(study, quick):
    """All runs. quick: coarser, for tests of this program itself."""
    fine = 40 if quick else 1
    data = {"gait": study.report("fixed-point", "--r0", 0.05)}
    for branch in ("long", "short"):
        data[branch] = study.rows(f"branch_{branch}", "continue", "--branch", branch, "--from", 0.05,
                                  "--to", 0.3, "--step", 0.05 if quick else 0.004)
        down = study.rows(f"branch_{branch}_down", "continue", "--branch", branch, "--from", 0.05, "--to",
                          0.002, "--step", 0.05, may_fail=True)
        data[branch] = down[:0:-1] + data[branch]
    data["table1"] = study.rows("table1", "doublings", "--from", 0.05, "--to", 0.1, "--count",
                                3 if quick else 7)
    data["table2"] = study.rows("table2", "doublings", "--from", 0.3, "--to", 0.23, "--count",
                                3 if quick else 7)
    low, high = column(data["table1"], "r0_m"), column(data["table2"], "r0_m")
    # Periods 2 and 4 between their doublings, started a little inside.
    for period, (a, b) in {2: (0, 1), 4: (1, 2)}.items():
        for side, edges in (("low", low), ("high", high)):
            start = edges[a] + 0.3 * (edges[b] - edges[a])
            data[f"period{period}_{side}"] = (
                study.rows(f"period{period}_{side}_a", "continue", "--period", period, "--from", start,
                           "--to", edges[a] + 0.002 * (edges[b] - edges[a]))[::-1] +
                study.rows(f"period{period}_{side}_b", "continue", "--period", period, "--from", start,
                           "--to", edges[b]))
    spans = {"all": (0.05, 0.3, 500), "low": (0.0845, 0.0908, 250), "high": (0.2392, 0.2455, 250)}
    for name, (start, end, points) in spans.items():
        data[f"bifurcation_{name}"] = study.rows(
            f"bifurcation_{name}", "bifurcation", "--from", start, "--to", end, "--points",
            max(points // fine, 8), "--transient", 100 if quick else 1000, "--keep", 100)
    edges = {"loss": (0.0995, 0.1025), "regain": (0.2245, 0.2265)}
    for name, (start, end) in edges.items():
        data[name] = study.rows(name, "bifurcation", "--from", start, "--to", end, "--points",
                                max(61 // fine, 5), "--transient", 100 if quick else 5000, "--keep", 4)
    data["chaos"] = study.rows("chaos", "bifurcation", "--from", 0.088, "--to", 0.1, "--points",
                               max(121 // fine, 5), "--transient", 100 if quick else 1000, "--keep", 200,
                               "--lyapunov", 50 if quick else 400)
    for axis, span in {"stance-rate": "-1,0", "swing-angle": "-0.3,0.3", "swing-rate": "0,2.6"}.items():
        data[f"basin_{axis}"] = study.rows(f"basin_{axis}", "basin", "--plane", f"r0,{axis}", "--a-range",
                                           "0.002,0.07", f"--b-range={span}", "--points",
                                           12 if quick else 140)
    data["gain"] = study.rows("gain", "gain", "--kp", "0,0.02,0.042,-0.042", "--from", 0.005, "--to", 0.3,
                              "--points", 240 // fine + 2)
    data["best"] = study.report("gain", "--best")
    gather_motion(study, data)
    return data


def gather_motion(study, data):
    """Traces for the phase portraits: period 1, 2, 4, 8 and chaos; and a recovery along the null direction."""
    gait, null = data["gait"]["x"], data["gait"]["smallest_eigenvector"]
    state = ",".join(repr(v) for v in gait)
    data["motion1"] = study.rows("motion1", "map", "--r0", 0.05, f"--state={state}", "--steps", 2,
                                 "--samples", 120)
    scale = 0.3 / math.hypot(*null)
    pushed = ",".join(repr(v + scale * n) for v, n in zip(gait, null))
    data["recovery"] = study.rows("recovery", "map", "--r0", 0.05, f"--state={pushed}", "--steps", 2,
                                  "--samples", 120)
    small = ",".join(repr(v + 1e-3 * n) for v, n in zip(gait, null))
    data["recovery_apexes"] = study.rows("recovery_apexes", "map", "--r0", 0.05, f"--state={small}",
                                         "--steps", 3)
    for name, r0, period in (("motion2", 0.08, 2), ("motion4", 0.087, 4), ("motion8", 0.0898, 8)):
        found = study.report("fixed-point", "--r0", r0, "--period", period)
        state = ",".join(repr(v) for v in found["x"])
        data[name] = study.rows(name, "map", "--r0", r0, f"--state={state}", "--steps", 2 * period,
                                "--samples", 60)
    last = [row for row in data["bifurcation_all"] if row["period"] == 0 and row["r0_m"] < 0.1]
    r0 = last[-1]["r0_m"] if last else 0.0945
    start = last[-1] if last else data["bifurcation_all"][0]
    state = ",".join(repr(start[k]) for k in ("stance_rate_rad_s", "swing_angle_rad", "swing_rate_rad_s"))
    data["motion_chaos"] = study.rows("motion_chaos", "map", "--r0", r0, f"--state={state}", "--steps", 60,
                                      "--samples", 40, may_fail=True)
    data["chaos_r0"] = r0
