"""Runs `afo study` for everything that the figures and tables of the page show, and reads the results."""
import csv
import json
import math
import pathlib
import subprocess

PAPER_GRAVITY_M_S2 = 9.80665


class PageError(Exception):
    """What is wrong, in words."""


class Walker:
    """A walker's parameters, and its units in the paper's: all ranges of the page are the paper's in these."""

    def __init__(self, hip_kg=1.0, leg_kg=0.01, leg_m=1.0, spring_N_m=100.0, gravity_m_s2=PAPER_GRAVITY_M_S2):
        self.numbers = {"M": hip_kg, "m": leg_kg, "l": leg_m, "k": spring_N_m, "g": gravity_m_s2}
        self.is_the_papers = self.numbers == {"M": 1.0, "m": 0.01, "l": 1.0, "k": 100.0, "g": PAPER_GRAVITY_M_S2}
        self.length = leg_m
        self.rate = math.sqrt(gravity_m_s2 / leg_m / PAPER_GRAVITY_M_S2)
        self.gain = leg_m / self.rate
        self.options = [] if self.is_the_papers else [
            word for name, value in self.numbers.items() for word in (f"--{name}", repr(value))]


class Study:
    """`afo study` of a walker, and a folder for what it printed. Files are made anew on every run."""

    def __init__(self, program, folder, walker=None):
        self.program = str(program)
        self.folder = pathlib.Path(folder)
        self.walker = walker or Walker()
        self.folder.mkdir(parents=True, exist_ok=True)

    def command(self, arguments, *more):
        return [self.program, "study", *map(str, arguments), *self.walker.options, *more, "--quiet"]

    def rows(self, name, *arguments, may_fail=False):
        """Runs a command with --csv; its rows as dictionaries, numbers where they are numbers. may_fail: none, where there
        is nothing to find."""
        path = self.folder / f"{name}.csv"
        path.unlink(missing_ok=True)
        command = self.command(arguments, "--csv", "--out", str(path))
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        if done.returncode != 0 and not (may_fail and done.returncode == 1):
            raise PageError(f"{' '.join(command)}: exit status {done.returncode} {done.stderr}".strip())
        if not path.is_file():
            return []
        with open(path, encoding="ascii", newline="") as file:
            return [{key: number(value) for key, value in row.items()} for row in csv.DictReader(file)]

    def report(self, *arguments, may_fail=False):
        """Runs a command with --json. may_fail: {} where there is nothing to find."""
        command = self.command(arguments, "--json")
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        if done.returncode != 0 and not (may_fail and done.returncode == 1):
            raise PageError(f"{' '.join(command)}: exit status {done.returncode} {done.stderr}".strip())
        return json.loads(done.stdout or "{}")


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def column(rows, name):
    return [row[name] for row in rows]


def gather(study, quick):
    """All runs. quick: coarser, for tests of this program itself."""
    fine, walker = 40 if quick else 1, study.walker
    l, strict = walker.length, walker.is_the_papers
    data = {"walker": walker, "gait": study.report("fixed-point", "--r0", 0.05 * l, may_fail=not strict)}
    if not data["gait"]:
        raise PageError(f"this walker has no steady gait at r0 = {0.05 * l:g} m, a twentieth of its leg, where the page begins; "
                        "`afo study table` with its --M --m --l --k --g tells where its gaits are")
    for branch in ("long", "short"):
        data[branch] = study.rows(f"branch_{branch}", "continue", "--branch", branch, "--from", 0.05 * l,
                                  "--to", 0.3 * l, "--step", 0.05 if quick else 0.004, may_fail=not strict)
        down = study.rows(f"branch_{branch}_down", "continue", "--branch", branch, "--from", 0.05 * l, "--to",
                          0.002 * l, "--step", 0.05, may_fail=True)
        data[branch] = down[:0:-1] + data[branch]
    if not data["long"]:
        raise PageError(f"the long branch could not be followed from r0 = {0.05 * l:g} m")
    top = data["long"][-1]["parameter"]
    ends = {"table1": (0.05, 0.1), "table2": (0.3, 0.23)} if strict else {"table1": (0.05, top / l), "table2": (top / l, 0.05)}
    for name, (start, end) in ends.items():
        data[name] = study.rows(name, "doublings", "--from", start * l, "--to", end * l, "--count",
                                3 if quick else 7, may_fail=not strict)
    gather_periods(study, data)
    spans = {"all": (0.05 * l, min(0.3 * l, top), 500), **spans_of(data)}
    for name, (start, end, points) in spans.items():
        data[f"bifurcation_{name}"] = study.rows(
            f"bifurcation_{name}", "bifurcation", "--from", start, "--to", end, "--points",
            max(points // fine, 8), "--transient", 100 if quick else 1000, "--keep", 100)
    gather_edges(study, data, quick)
    for axis, span in {"stance-rate": (-1, 0), "swing-angle": (-0.3, 0.3), "swing-rate": (0, 2.6)}.items():
        unit = 1.0 if axis == "swing-angle" else walker.rate
        data[f"basin_{axis}"] = study.rows(
            f"basin_{axis}", "basin", "--plane", f"r0,{axis}", "--a-range", f"{0.002 * l!r},{0.07 * l!r}",
            f"--b-range={span[0] * unit!r},{span[1] * unit!r}", "--points", 12 if quick else 140)
    gains = (0, 0.02, 0.042, -0.042)
    data["gains"] = [gain * walker.gain for gain in gains]
    data["gain"] = study.rows("gain", "gain", "--kp", ",".join(repr(gain) for gain in data["gains"]), "--from", 0.005 * l,
                              "--to", 0.3 * l if strict else 0.999 * top, "--points", 240 // fine + 2, may_fail=not strict)
    data["best"] = study.report("gain", "--best", may_fail=not strict)
    gather_motion(study, data)
    return data


def gather_periods(study, data):
    """Periods 2 and 4 between their doublings, started a little inside; none where there are no doublings."""
    low, high = column(data["table1"], "r0_m"), column(data["table2"], "r0_m")
    for period, (a, b) in {2: (0, 1), 4: (1, 2)}.items():
        for side, edges in (("low", low), ("high", high)):
            name = f"period{period}_{side}"
            if len(edges) <= b:
                data[name] = []
                continue
            start = edges[a] + 0.3 * (edges[b] - edges[a])
            data[name] = (
                study.rows(f"{name}_a", "continue", "--period", period, "--from", start,
                           "--to", edges[a] + 0.002 * (edges[b] - edges[a]))[::-1] +
                study.rows(f"{name}_b", "continue", "--period", period, "--from", start,
                           "--to", edges[b]))


def spans_of(data):
    """Where the cascades are magnified: the paper's own axes, or from before the second doubling to behind the last."""
    if data["walker"].is_the_papers:
        return {"low": (0.0845, 0.0908, 250), "high": (0.2392, 0.2455, 250)}
    spans = {}
    for name, table in (("low", "table1"), ("high", "table2")):
        doublings = column(data[table], "r0_m")
        if len(doublings) > 2:
            cascade = doublings[-1] - doublings[1]
            spans[name] = (*sorted((doublings[1] - 0.05 * cascade, doublings[-1] + 0.05 * cascade)), 250)
    return spans


def edges_of(data):
    """Around which r0 long runs stop to walk, and start again: the paper's, or the first and the last such of the runs."""
    if data["walker"].is_the_papers:
        return {"loss": (0.0995, 0.1025), "regain": (0.2245, 0.2265)}
    walks = {}
    for row in data["bifurcation_all"]:
        walks[row["r0_m"]] = row["period"] >= 0
    points = sorted(walks)
    pairs = list(zip(points, points[1:]))
    lost = [pair for pair in pairs if walks[pair[0]] and not walks[pair[1]]]
    found = [pair for pair in pairs if not walks[pair[0]] and walks[pair[1]]]
    return {name: pair for name, pair in (("loss", lost[:1]), ("regain", found[-1:])) for pair in pair}


def gather_edges(study, data, quick):
    fine = 40 if quick else 1
    edges = edges_of(data)
    for name in ("loss", "regain"):
        data[name] = study.rows(
            name, "bifurcation", "--from", edges[name][0], "--to", edges[name][1], "--points", max(61 // fine, 5),
            "--transient", 100 if quick else 5000, "--keep", 4) if name in edges else []
    cascade = column(data["table1"], "r0_m")
    ends = (0.088, 0.1) if data["walker"].is_the_papers else (cascade[1], edges["loss"][0]) if (
        len(cascade) > 1 and "loss" in edges and edges["loss"][0] > cascade[1]) else None
    data["chaos"] = study.rows(
        "chaos", "bifurcation", "--from", ends[0], "--to", ends[1], "--points", max(121 // fine, 5), "--transient",
        100 if quick else 1000, "--keep", 200, "--lyapunov", 50 if quick else 400) if ends else []


def motions_of(data):
    """The r0 of the portraits of periods 2, 4 and 8: the paper's, or in the middle between the doublings."""
    if data["walker"].is_the_papers:
        return (("motion2", 0.08, 2), ("motion4", 0.087, 4), ("motion8", 0.0898, 8))
    low = column(data["table1"], "r0_m")
    return tuple((f"motion{2 ** n}", 0.5 * (low[n - 1] + low[n]), 2 ** n) for n in (1, 2, 3) if len(low) > n)


def gather_motion(study, data):
    """Traces for the phase portraits: period 1, 2, 4, 8 and chaos; and a recovery along the null direction."""
    l = study.walker.length
    gait, null = data["gait"]["x"], data["gait"].get("smallest_eigenvector", [0.0, 0.0, 1.0])
    state = ",".join(repr(v) for v in gait)
    data["motion1"] = study.rows("motion1", "map", "--r0", 0.05 * l, f"--state={state}", "--steps", 2,
                                 "--samples", 120)
    scale = 0.3 / math.hypot(*null)
    pushed = ",".join(repr(v + scale * n) for v, n in zip(gait, null))
    data["recovery"] = study.rows("recovery", "map", "--r0", 0.05 * l, f"--state={pushed}", "--steps", 2,
                                  "--samples", 120, may_fail=True)
    small = ",".join(repr(v + 1e-3 * n) for v, n in zip(gait, null))
    data["recovery_apexes"] = study.rows("recovery_apexes", "map", "--r0", 0.05 * l, f"--state={small}",
                                         "--steps", 3)
    data["motions"] = []
    for name, r0, period in motions_of(data):
        found = study.report("fixed-point", "--r0", r0, "--period", period, may_fail=not study.walker.is_the_papers)
        if not found:
            continue
        state = ",".join(repr(v) for v in found["x"])
        data[name] = study.rows(name, "map", "--r0", r0, f"--state={state}", "--steps", 2 * period,
                                "--samples", 60)
        data["motions"].append((name, f"period {period}, $r_0$ = {r0:.4g}"))
    gather_chaos(study, data)


def gather_chaos(study, data):
    middle = 0.1 * study.walker.length if study.walker.is_the_papers else math.inf
    last = [row for row in data["bifurcation_all"] if row["period"] == 0 and row["r0_m"] < middle]
    if not last and not study.walker.is_the_papers:
        return
    r0 = last[-1]["r0_m"] if last else 0.0945
    start = last[-1] if last else data["bifurcation_all"][0]
    state = ",".join(repr(start[k]) for k in ("stance_rate_rad_s", "swing_angle_rad", "swing_rate_rad_s"))
    data["motion_chaos"] = study.rows("motion_chaos", "map", "--r0", r0, f"--state={state}", "--steps", 60,
                                      "--samples", 40, may_fail=True)
    data["motions"].append(("motion_chaos", f"chaos, $r_0$ = {r0:.4f}"))
