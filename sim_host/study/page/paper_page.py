"""One HTML page: the paper's printed numbers beside those found, and the figures."""
import html

from paper_misprints import checks

STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}
table{border-collapse:collapse;margin:1rem 0}td,th{border:1px solid #ccc;padding:.25rem .6rem;text-align:right}
th{background:#f2f4f8}td:first-child,th:first-child{text-align:left}td.words{text-align:left}
img{max-width:100%;border:1px solid #ddd}figure{margin:1.5rem 0}figcaption{color:#555}"""

CAPTIONS = {
    4: "Phase portrait of one leg over two steps.",
    5: "A disturbance along the eigenvector of the zero eigenvalue is gone after one collision.",
    6: "Both period-1 fixed points over r<sub>0</sub>, and cross-sections of the basin of attraction.",
    7: "Eigenvalues of both fixed points.",
    8: "Long runs over r<sub>0</sub>: period doubling, chaos, loss of walking and its return.",
    9: "Eigenvalue magnitudes of the stable gaits up to period 4.",
    10: "Phase portraits of period 2, 4, 8 and of chaos.",
    11: "Inter-leg angle at heel strike.",
    12: "Eigenvalues without and with the step law.",
}

TABLES = {"table1": [0.06573, 0.08486, 0.08927, 0.09023, 0.090438],
          "table2": [0.26108, 0.24464, 0.240624, 0.239728, 0.239534]}
RATIOS = {"table1": [None, None, 4.3379, 4.5937, 4.6154], "table2": [None, None, 4.0895, 4.47, 4.6186]}


def row(*cells, tag="td"):
    return "<tr>" + "".join(f"<{tag}>{cell}</{tag}>" for cell in cells) + "</tr>"


def compare(name, printed, found, digits=7):
    return row(name, f"{printed:g}", f"{found:.{digits}f}", f"{found - printed:+.1e}")


def gait_table(data):
    gait = data["gait"]
    names = ["stance rate (rad/s)", "swing angle (rad)", "swing rate (rad/s)"]
    lines = [row("at r<sub>0</sub> = 0.05 m", "paper", "found", "difference", tag="th")]
    lines += [compare(n, p, f) for n, p, f in zip(names, (-0.4069, -0.0596, 1.7568), gait["x"])]
    for i, printed in enumerate((-0.5715, -0.1102, 0.0)):
        lines.append(compare(f"eigenvalue {i + 1}", printed, gait["eigenvalues"][i][0]))
    for i, printed in enumerate((0.0031, 0.4389, 0.8985)):
        lines.append(compare(f"eigenvector of 0, entry {i + 1}", printed, gait["smallest_eigenvector"][i]))
    return lines


def doubling_table(data, name):
    lines = [row("n", "new period", "paper (m)", "found (m)", "difference", "ratio, paper", "ratio, found", tag="th")]
    for i, found in enumerate(data[name]):
        printed = TABLES[name][i] if i < 5 else None
        ratio = RATIOS[name][i] if i < 5 else None
        lines.append(row(i + 1, f"{found['new_period']:.0f}", f"{printed:g}" if printed else "&ndash;",
                         f"{found['r0_m']:.10f}", f"{found['r0_m'] - printed:+.1e}" if printed else "&ndash;",
                         f"{ratio:g}" if ratio else "&ndash;",
                         f"{found['ratio']:.4f}" if found["ratio"] == found["ratio"] else "&ndash;"))
    return lines


def edges(data):
    """Where long runs stop and start to walk."""
    walked = [r["r0_m"] for r in data["loss"] if r["period"] >= 0]
    again = [r["r0_m"] for r in data["regain"] if r["period"] >= 0]
    chaotic = sorted({r["r0_m"] for r in data["chaos"] if r["lyapunov"] > 0.005})
    return [("first chaotic walk above the cascade (Lyapunov exponent &gt; 0)", 0.0905,
             min(chaotic, default=float("nan"))),
            ("walking is lost above", 0.1, max(walked, default=float("nan"))),
            ("walking is regained, chaotic, from", 0.2255, min(again, default=float("nan")))]


def write(data, folder, commands):
    misprints = [row("place", "printed", "right", "check", "as printed", "as right", tag="th")]
    for place, printed, right, words, bad, good in checks(data):
        numbers = ["&ndash;" if v is None else f"{v:.2g}" for v in (bad, good)]
        misprints.append(row(place, *(f"<span>{t}</span>" for t in (printed, right, words)), *numbers))
    zero = max(abs(complex(r["re3"], r["im3"])) for b in ("long", "short") for r in data[b])
    moved = data["recovery_apexes"]
    gait = data["gait"]["x"]
    keys = ("stance_rate_rad_s", "swing_angle_rad", "swing_rate_rad_s")
    away = [max(abs(r[k] - g) for k, g in zip(keys, gait)) for r in moved]
    law = [r for r in data["gain"] if r["kp"] == 0.042 and 0.05 <= r["r0_m"] <= 0.27]
    best = data["best"]
    parts = [
        "<!doctype html><meta charset=utf-8><title>The paper, reproduced</title>", f"<style>{STYLE}</style>",
        "<h1>The paper, reproduced</h1>",
        "<p><i>Stability and control of planar compass gait walking with series-elastic "
        "ankle actuation</i>: its printed numbers beside those of this model; M = 1 kg, m = 0.01 kg, l = 1 m, k = 100 N/m, "
        "g = 9.80665 m/s&sup2;.</p>",
        "<h2>The gait</h2><table>", *gait_table(data), "</table>",
        f"<p>Largest magnitude of the eigenvalue that is always zero, on both branches over the whole range: {zero:.1e}. "
        "Only the toe distance and the ankle's rate survive a collision, two numbers of three: the map's derivative has "
        f"rank two. A start {away[0]:.1e} off the gait along its direction is {away[1]:.1e} off one stride later (what is left is "
        "of second order).</p>",
        "<h2>Table 1: period doublings upwards</h2><table>", *doubling_table(data, "table1"), "</table>",
        "<h2>Table 2: period doublings downwards from 0.3 m</h2><table>", *doubling_table(data, "table2"), "</table>",
        "<p>Ratios tend to Feigenbaum's 4.669.</p>",
        "<h2>Long runs</h2><table>", row("r<sub>0</sub> (m)", "paper", "found", "difference", tag="th"),
        *(compare(*edge, digits=5) for edge in edges(data)), "</table>",
        "<h2>The step law</h2>",
        f"<p>With k<sub>p</sub> = 0.042 the largest eigenvalue over 0.05 &le; r<sub>0</sub> &le; 0.27 lies between "
        f"{min(r['largest'] for r in law):.3f} and {max(r['largest'] for r in law):.3f}: stable everywhere. The gain that makes "
        f"it smallest is {best['best_kp']:.5f}, with {best['largest_with_best_kp']:.4f}; without the law it reaches "
        f"{best['largest_without_law']:.4f}.</p>",
        "<h2>Where the print is wrong</h2><table>", *misprints, "</table>",
        "<h2>Figures</h2>",
    ]
    for i, caption in CAPTIONS.items():
        parts.append(f"<figure><a href=figure{i:02d}.svg><img src=figure{i:02d}.png alt='Figure {i}'></a>"
                     f"<figcaption>Figure {i}. {caption}</figcaption></figure>")
    parts.append("<h2>How it was made</h2><p>" + html.escape(commands) + "</p>")
    (folder / "index.html").write_text("\n".join(parts) + "\n", encoding="utf-8")
