"""Draws Figures 4 to 12 of the paper for any walker; for the paper's, in the paper's own axes."""
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from page_data import column  # noqa: E402

STABLE, UNSTABLE, THIRD = "#0b4fa8", "#c22f2f", "#4f7f2f"
STATES = [("stance_rate_rad_s", r"$\dot\theta_s$ (rad/s)"), ("swing_angle_rad", r"$\theta_n$ (rad)"),
          ("swing_rate_rad_s", r"$\dot\theta_n$ (rad/s)")]
R0 = r"$r_0$ (m)"

plt.rcParams.update({"font.size": 9, "axes.grid": True, "grid.alpha": 0.25, "axes.axisbelow": True,
                     "savefig.dpi": 150, "figure.constrained_layout.use": True})


def save(figure, folder, name):
    figure.savefig(folder / f"{name}.png")
    figure.savefig(folder / f"{name}.svg")
    plt.close(figure)


def split(rows, key, value=lambda row: row["stable"] == "true"):
    """Runs of consecutive points with the same stability, overlapping by one so that lines stay joined."""
    runs, start = [], 0
    for i in range(1, len(rows) + 1):
        if i == len(rows) or value(rows[i]) != value(rows[start]):
            part = rows[start:min(i + 1, len(rows))]
            runs.append((value(rows[start]), column(part, "parameter"), column(part, key)))
            start = i
    return runs


def draw_branch(axes, rows, key, width=1.3):
    for stable, x, y in split(rows, key):
        axes.plot(x, y, color=STABLE if stable else UNSTABLE, linestyle="-" if stable else "--", lw=width)


def legs(rows, leg=0):
    """Angle and rate of leg A (0) or B (1) with NaN at the collisions' jumps, and the jumps by themselves.

    Leg A starts as the stance leg; legs swap names at every lift-off."""
    line, jumps, phase = [], [], None
    for row in rows:
        # Stride k runs from apex to apex: leg A stands before lift-off in even strides.
        swapped = (int(row["stride"]) + (row["phase"] == "after_lift_off") + leg) % 2
        here = (row["swing_angle_rad" if swapped else "stance_angle_rad"],
                row["swing_rate_rad_s" if swapped else "stance_rate_rad_s"])
        if row["phase"] == "double" and phase == "before_strike":
            jumps += [line[-1], here, (math.nan, math.nan)]
            line.append((math.nan, math.nan))
        phase = row["phase"]
        line.append(here)
    return list(zip(*line)), list(zip(*jumps))


def events(rows):
    """The four events of Figure 4: start and end of push-off of leg A, then of leg B."""
    found = []
    for i, row in enumerate(rows):
        if row["phase"] == "double" and rows[i - 1]["phase"] != "double":
            found.append(i)
        if row["phase"] != "double" and i > 0 and rows[i - 1]["phase"] == "double":
            found.append(i - 1)
    points = []
    for i in found[:4]:
        swapped = int(rows[i]["stride"]) % 2
        points.append((rows[i]["swing_angle_rad" if swapped else "stance_angle_rad"],
                       rows[i]["swing_rate_rad_s" if swapped else "stance_rate_rad_s"]))
    return points


def portrait(axes, rows, leg=0, **style):
    line, jumps = legs(rows, leg)
    axes.plot(*line, **style)
    axes.plot(*jumps, color=style["color"], lw=0.6, ls=":")
    axes.set_xlabel(r"$\theta$ (rad)")
    axes.set_ylabel(r"$\dot\theta$ (rad/s)")


def figure4(data, folder):
    figure, axes = plt.subplots(figsize=(5, 4))
    portrait(axes, data["motion1"], color=STABLE, lw=1.4)
    for i, (x, y) in enumerate(events(data["motion1"])):
        axes.plot(x, y, "o", color=UNSTABLE, ms=5)
        axes.annotate(str(i + 1), (x, y), textcoords="offset points", xytext=(6, 5))
    axes.set_title(f"Period-1 gait, $r_0$ = {data['gait']['r0_m']:.4g} m (push-off starts/ends: leg A 1, 2; leg B 3, 4)", fontsize=8)
    save(figure, folder, "figure04")


def figure5(data, folder):
    figure, axes = plt.subplots(figsize=(5, 4))
    portrait(axes, data["motion1"], leg=1, color=STABLE, lw=1.4, label="gait")
    if data["recovery"]:
        portrait(axes, data["recovery"], leg=1, color=UNSTABLE, lw=1.1, ls="--",
                 label=r"started 0.3 along the eigenvector of $\lambda$ = 0")
        angle, rate = (data["recovery"][0][key] for key in ("swing_angle_rad", "swing_rate_rad_s"))
        axes.plot(angle, rate, "o", color=UNSTABLE, ms=5)
    axes.legend(fontsize=7, loc="center")
    save(figure, folder, "figure05")


def figure6(data, folder):
    figure, axes = plt.subplots(3, 2, figsize=(8, 7), sharex="col")
    for i, (key, label) in enumerate(STATES):
        for branch in ("long", "short"):
            draw_branch(axes[i][0], data[branch], key)
            inside = [row for row in data[branch] if row["parameter"] <= 0.0702 * data["walker"].length]
            axes[i][1].set_ylabel(label)
            draw_branch(axes[i][1], inside, key)
        axes[i][0].set_ylabel(label)
        rows = data["basin_" + ("stance-rate", "swing-angle", "swing-rate")[i]]
        xs, ys = sorted({row["a"] for row in rows}), sorted({row["b"] for row in rows})
        # Converging, or walking on for hundreds of strides (close to the doubling it takes long).
        inside = {(row["a"], row["b"]): row["outcome"] > 0 for row in rows}
        axes[i][1].pcolormesh(xs, ys, [[1.0 if inside[x, y] else math.nan for x in xs] for y in ys],
                              cmap="Reds", vmin=0, vmax=4, shading="nearest", rasterized=True)
        good = [y for (x, y), is_good in inside.items() if is_good] or ys
        axes[i][1].set_ylim(min(good) - 0.02, max(good) + 0.02)
    for axes_of_column in axes[2]:
        axes_of_column.set_xlabel(R0)
    axes[0][0].set_title("fixed points (dashed: unstable)", fontsize=9)
    axes[0][1].set_title("basin of the stable one, one coordinate varied", fontsize=9)
    save(figure, folder, "figure06")


def eigenvalues(axes, rows):
    for k, colour in ((1, STABLE), (2, THIRD), (3, "#777777")):
        x = column(rows, "parameter")
        axes.plot(x, column(rows, f"re{k}"), color=colour, lw=1.3, label=rf"Re $\lambda_{k}$")
        imaginary = [row[f"im{k}"] or math.nan for row in rows]
        axes.plot(x, imaginary, color=colour, lw=1.0, ls=":")
    for limit in (-1, 1):
        axes.axhline(limit, color="k", lw=0.8, ls="--")


def figure7(data, folder):
    figure, axes = plt.subplots(2, 1, figsize=(5.5, 6), sharex=True)
    for axis, branch, title in ((axes[0], "long", "long branch"), (axes[1], "short", "short branch")):
        eigenvalues(axis, data[branch])
        axis.set_ylabel(r"$\lambda$")
        axis.set_title(f"{title} (dotted: imaginary parts)", fontsize=9)
    axes[1].set_xlabel(R0)
    axes[0].legend(fontsize=7)
    save(figure, folder, "figure07")


def dots(axes, rows, key, size=0.7):
    good = [row for row in rows if row["period"] >= 0]
    periodic = [row for row in good if row["period"] > 0 and row["sample"] < row["period"]]
    chaotic = [row for row in good if row["period"] == 0]
    for part in (periodic, chaotic):
        axes.plot(column(part, "r0_m"), column(part, key), ".", color=STABLE, ms=size, mew=0,
                  rasterized=True)


def diagram(data, folder, name, keys):
    columns = len(keys)
    figure, axes = plt.subplots(columns, 3, figsize=(11, 2.9 * columns), squeeze=False,
                                width_ratios=[2, 1, 1])
    for i, (key, label) in enumerate(keys):
        draw_branch(axes[i][0], [row for row in data["long"] if row["parameter"] > 0.002], key, 0.9)
        dots(axes[i][0], data["bifurcation_all"], key, 1.6)
        axes[i][0].set_ylabel(label)
        for axis, part in ((axes[i][1], "low"), (axes[i][2], "high")):
            if not data.get(f"bifurcation_{part}"):
                continue
            dots(axis, data[f"bifurcation_{part}"], key, 1.6)
            inside = [row for row in data["long"]
                      if data[f"bifurcation_{part}"][0]["r0_m"] <= row["parameter"]
                      <= data[f"bifurcation_{part}"][-1]["r0_m"]]
            axis.plot(column(inside, "parameter"), column(inside, key), "--", color=UNSTABLE, lw=0.9)
    for axis, title in zip(axes[0], ("all", "magnified: periods 2 to 32, chaos", "magnified: chaos, 32 to 2")):
        axis.set_title(title, fontsize=9)
    for axis in axes[-1]:
        axis.set_xlabel(R0)
    save(figure, folder, name)


def magnitudes(rows, period):
    values = []
    for k in (1, 2, 3):
        values.append([math.hypot(row[f"re{k}"], row[f"im{k}"]) ** (1.0 / period) for row in rows])
    return column(rows, "parameter"), values


def figure9(data, folder):
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True)
    middle = 0.5 * (data["table1"][-1]["r0_m"] + data["table2"][-1]["r0_m"])
    for axis, side in ((axes[0], "low"), (axes[1], "high")):
        inside = [row for row in data["long"] if (row["stable"] == "true" or row["event"] == "doubling") and
                  (row["parameter"] < middle) == (side == "low")]
        for period, rows in ((1, inside), (2, data[f"period2_{side}"]), (4, data[f"period4_{side}"])):
            if not rows:
                continue
            x, values = magnitudes(rows, period)
            for k, colour in enumerate((STABLE, THIRD, "#777777")):
                axis.plot(x, values[k], color=colour, lw=1.2)
            axis.axvspan(min(x), max(x), color=("white", "#eef3fb", "#fbf1e6")[(1, 2, 4).index(period)],
                         zorder=0)
        axis.axhline(1, color="k", lw=0.8, ls="--")
        axis.set_xlabel(R0)
    axes[0].set_ylabel(r"$|\lambda|^{1/n}$, period $n$")
    axes[0].set_title("shaded: periods 2 and 4", fontsize=9)
    save(figure, folder, "figure09")


def figure10(data, folder):
    figure, axes = plt.subplots(2, 2, figsize=(8, 6.4), sharex=True, sharey=True)
    for axis, (name, title) in zip(axes.flat, data["motions"]):
        portrait(axis, data[name], color=STABLE, lw=0.7)
        portrait(axis, data[name], leg=1, color=UNSTABLE, lw=0.7)
        axis.set_title(f"{title} (leg A blue, leg B red)", fontsize=9)
    for axis in axes.flat[len(data["motions"]):]:
        axis.set_visible(False)
    save(figure, folder, "figure10")


def figure12(data, folder):
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.4), sharey=True)
    for axis, gain in zip(axes, data["gains"]):
        rows = [dict(row, parameter=row["r0_m"]) for row in data["gain"] if row["kp"] == gain]
        eigenvalues(axis, rows)
        axis.set_title(f"$k_p$ = {gain:.4g}", fontsize=9)
        axis.set_xlabel(R0)
    axes[0].set_ylabel(r"$\lambda$ (dotted: imaginary part)")
    axes[0].legend(fontsize=7)
    save(figure, folder, "figure12")


def draw_all(data, folder):
    """Draws what there are numbers for; {figure's number: what is missing, in words} of the others."""
    missing = {}
    figure4(data, folder)
    figure5(data, folder)
    if data["short"]:
        figure6(data, folder)
        figure7(data, folder)
    else:
        missing[6] = missing[7] = "no gait of the short branch was found"
    diagram(data, folder, "figure08", STATES)
    if data["table1"] and data["table2"]:
        figure9(data, folder)
    else:
        missing[9] = "no period doublings from both ends were found"
    if data["motions"]:
        figure10(data, folder)
    else:
        missing[10] = "no gait of period 2, 4 or 8, and no chaos, was found"
    diagram(data, folder, "figure11", [("inter_leg_rad", "inter-leg angle at strike (rad)")])
    if data["gain"]:
        figure12(data, folder)
    else:
        missing[12] = "the long branch was lost"
    return missing
