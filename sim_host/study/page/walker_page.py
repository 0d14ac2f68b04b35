"""One HTML page: the tables and figures of the paper, for another walker."""
import html

from paper_page import CAPTIONS, STYLE, row

FEIGENBAUM = 4.669201609  # 1978


def gait_table(gait):
    """The gait that the page begins with, at a twentieth of the leg."""
    lines = [row(f"at r<sub>0</sub> = {gait['r0_m']:.5g} m", "found", tag="th")]
    for name, value in zip(("stance rate (rad/s)", "swing angle (rad)", "swing rate (rad/s)"), gait["x"]):
        lines.append(row(name, f"{value:.7f}"))
    for i, (real, imaginary) in enumerate(gait["eigenvalues"], 1):
        lines.append(row(f"eigenvalue {i}", f"{real:.6f}" + (f" {imaginary:+.6f} i" if imaginary else "")))
    for name, key in (("walking speed (m/s)", "speed_m_s"), ("step length (m)", "step_length_m"),
                      ("cadence (steps/min)", "cadence_per_min"), ("stance (% of the cycle)", "stance_percent"),
                      ("double support (% of the step)", "double_support_percent"), ("push-off (J)", "push_off_J"),
                      ("push-off (J/kg)", "push_off_J_per_kg"), ("cost of transport", "cost_of_transport"),
                      ("margin of stability (m)", "margin_of_stability_m")):
        lines.append(row(name, f"{gait[key]:.5g}"))
    return lines


def doubling_table(rows):
    lines = [row("n", "new period", "r<sub>0</sub> (m)", "ratio", tag="th")]
    for found in rows:
        ratio = found["ratio"]
        lines.append(row(f"{found['n']:.0f}", f"{found['new_period']:.0f}", f"{found['r0_m']:.8f}",
                         f"{ratio:.4f}" if ratio == ratio else "&ndash;"))
    return lines


def doublings(title, rows):
    words = (["<p>None was found: every steady gait on this way keeps its period.</p>"] if not rows else
             ["<table>", *doubling_table(rows), "</table>"])
    return [f"<h2>{title}</h2>", *words]


def edges(data):
    walked = [r["r0_m"] for r in data["loss"] if r["period"] >= 0]
    again = [r["r0_m"] for r in data["regain"] if r["period"] >= 0]
    chaotic = sorted({r["r0_m"] for r in data["chaos"] if r["lyapunov"] > 0.005 * data["walker"].rate})
    for name, found in (("first chaotic walk above the cascade (Lyapunov exponent &gt; 0)", chaotic[:1]),
                        ("walking is lost above", [max(walked)] if walked else []),
                        ("walking is regained from", [min(again)] if again else [])):
        yield row(name, f"{found[0]:.5f}" if found else "not found")


def law_words(data):
    l, gain = data["walker"].length, data["gains"][2]
    law = [r["largest"] for r in data["gain"] if r["kp"] == gain and 0.05 * l <= r["r0_m"] <= 0.27 * l]
    best = data["best"]
    words = []
    if law:
        words.append(f"With k<sub>p</sub> = {gain:.4g} m per rad/s, the paper's gain in this walker's units, the largest "
                     f"eigenvalue over {0.05 * l:.4g} to {0.27 * l:.4g} m lies between {min(law):.3f} and {max(law):.3f}.")
    if best:
        words.append(f"The gain that makes it smallest is {best['best_kp']:.5f}, with {best['largest_with_best_kp']:.4f}"
                     + (": stable everywhere" if best["stable_with_best_kp"] else ": no gain stabilises this walker everywhere")
                     + f"; without the law it reaches {best['largest_without_law']:.4f}.")
    return " ".join(words) or "The long branch was lost before its end, so there is no best gain."


def figures(missing):
    for i, caption in CAPTIONS.items():
        if i in missing:
            yield f"<p>Figure {i} is not here: {missing[i]}.</p>"
        else:
            yield (f"<figure><a href=figure{i:02d}.svg><img src=figure{i:02d}.png alt='Figure {i}'></a>"
                   f"<figcaption>Figure {i}. {caption}</figcaption></figure>")


def write(data, folder, who, missing, command):
    numbers = data["walker"].numbers
    title = f"The paper's page for {who}"
    parts = [
        "<!doctype html><meta charset=utf-8>", f"<title>{html.escape(title)}</title><style>{STYLE}</style>",
        f"<h1>{html.escape(title)}</h1>",
        f"<p>A compass walker with M = {numbers['M']:g} kg, m = {numbers['m']:g} kg, l = {numbers['l']:g} m, "
        f"k = {numbers['k']:g} N/m, g = {numbers['g']:g} m/s&sup2;. In its own units: m/M = {numbers['m'] / numbers['M']:.4g}, "
        f"k l / (M g) = {numbers['k'] * numbers['l'] / numbers['M'] / numbers['g']:.4g}. Tables and figures are numbered as in "
        "<i>Stability and control of planar compass gait walking with series-elastic ankle actuation</i>; the paper's own "
        "walker is <code>make paper</code>.</p>",
        "<h2>The gait</h2><table>", *gait_table(data["gait"]), "</table>",
        *doublings(f"Table 1: period doublings upwards from {0.05 * numbers['l']:.4g} m", data["table1"]),
        *doublings(f"Table 2: period doublings downwards from {data['long'][-1]['parameter']:.4g} m", data["table2"]),
        f"<p>Ratios tend to Feigenbaum's {FEIGENBAUM:.4g} where the cascade is whole.</p>",
        "<h2>Long runs</h2><table>", row("", "r<sub>0</sub> (m)", tag="th"), *edges(data), "</table>",
        "<h2>The step law</h2>", f"<p>{law_words(data)}</p>",
        "<h2>Figures</h2>", *figures(missing),
        "<h2>How it was made</h2>", f"<p>{html.escape(command)}. The folder data beside this page holds every number as CSV; "
        "the file .json beside each says which command made it.</p>",
    ]
    (folder / "index.html").write_text("\n".join(parts) + "\n", encoding="utf-8")
