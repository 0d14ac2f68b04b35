#!/usr/bin/env python3
"""One page of a trial, or of two beside each other, in one HTML file that needs nothing else."""
import argparse
import html
import os
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from serve import EXIT_USAGE, missing_packages  # noqa: E402

STYLE = """:root{color-scheme:light dark}body{font:15px/1.45 system-ui,sans-serif;max-width:66rem;margin:1rem auto;padding:0 1rem}
table{border-collapse:collapse;margin:.4rem 0}th,td{text-align:left;padding:.12rem .8rem .12rem 0;border-bottom:1px solid #8884;
font-variant-numeric:tabular-nums;vertical-align:top}svg{width:100%;max-width:40rem;height:auto;display:inline-block}
svg .grid{stroke:#8884}svg .mark{stroke:#b3261e;stroke-dasharray:3 3}svg text{font:11px system-ui}svg text:not(.name){fill:currentColor}
svg .title{font-weight:600;font-size:13px}.bad{color:#b3261e;font-weight:600}details{margin:.4rem 0}"""
CURVES = (("leg_angle", "Leg angle", "rad"), ("ankle", "Ankle extension", "m"), ("motor", "Precompression", "m"),
          ("spring_force", "Spring force", "N"))
AROUND_S = 5.0
STEPS_SHOWN = 400


def esc(value):
    return html.escape(str(value))


def number(value):
    return "" if value is None else f"{value:.5g}" if isinstance(value, float) else str(value)


def table(head, rows):
    cells = "".join(f"<th scope=col>{esc(one)}</th>" for one in head)
    body = "".join("<tr>" + "".join(f"<td>{esc(number(one))}</td>" for one in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"


# ---- one trial -----------------------------------------------------------------------


def heading(walk):
    told, subject = walk.told, walk.subject
    rows = [("subject's code", told.get("subject_code") or "none"), ("note", told.get("note", "")),
            ("begun (UTC)", told.get("begun_utc", "")), ("source", told.get("source", walk.name)),
            ("person", subject["person"]), ("device", f"{subject['device']} ({subject['device_file'] or 'as delivered'})"),
            ("version", f"{subject['version']}, build {subject['build_id']:08x}")]
    text = "".join(f"<tr><th scope=row>{esc(a)}</th><td>{esc(b)}</td></tr>" for a, b in rows)
    if "replay_from" in told:
        import trial
        command, where = trial.how_to_replay(told, walk.folder)
        text += f"<tr><th scope=row>replay, {esc(where)}</th><td><code>{esc(command)}</code></td></tr>"
    if not told["complete"]:
        text += f"<tr><th scope=row>incomplete</th><td class=bad>{esc(told['lacks'])}</td></tr>"
    return f"<table>{text}</table>"


def by_step(walks):
    from svg import Chart
    speed, r0 = Chart("Apex speed by step", "rad/s", "step"), Chart("Precompression wanted by step", "m", "step")
    for walk in walks:
        label = f"{walk.name}: " if len(walks) > 1 else ""
        x = [step["number"] for step in walk.steps]
        speed.add(x, [step["speed_rad_s"] for step in walk.steps], f"{label}measured", dots=len(x) < 150)
        speed.add(x, [step["command_rad_s"] for step in walk.steps], f"{label}asked for", dash=True)
        r0.add(x, [step["r0_m"] for step in walk.steps], f"{label}r0", dots=len(x) < 150)
    return speed.text() + r0.text()


def curves(walks):
    from svg import Chart
    from signals import SIDES
    parts = []
    for name, title, unit in CURVES:
        for side in (0, 1) if len(walks) > 1 else (None,):
            chart = Chart(f"{title}{f', {SIDES[side]}' if side is not None else ''}", unit, "% of the stride")
            for walk in walks:
                for one in (0, 1) if side is None else (side,):
                    percent, mean, deviation, count = walk.ensemble(one, name)
                    if count:
                        label = SIDES[one] if side is None else walk.name
                        chart.add(percent, mean, f"{label} ({count})", band=deviation)
            parts.append(chart.text())
    return "".join(parts)


def findings(walk):
    """What the seconds before a fault show, in words."""
    parts = []
    for event in walk.of_kind("state"):
        if not event["fault_number"]:
            continue
        fault = event["fault"]
        parts.append(f"<h3>{event['tick'] * walk.tick_s:.2f} s: {esc(fault['name'])}</h3><p class=bad>{esc(fault['what'])}</p>"
                     f"<p>What to do: {esc(fault['todo'])}</p>")
        notes = next((e["notes"] for e in walk.of_kind("finding") if e["tick"] == event["tick"]), [])
        parts.append("<ul>" + "".join(f"<li>{esc(text)}</li>" for text in notes) + "</ul>" if notes else "")
        parts.append(around(walk, event["tick"], fault["name"]))
        if len(parts) > 80:
            break
    return "".join(parts) or "<p>No fault.</p>"


def around(walk, tick, text):
    """The five seconds around a tick."""
    import numpy as np
    from signals import SIDES
    from svg import Chart, thin
    span = int(AROUND_S / walk.tick_s)
    first, last = max(0, tick - span), min(len(walk.rows), tick + span)
    x = np.arange(first, last) * walk.tick_s
    parts = []
    for name, title, unit in CURVES:
        chart = Chart(title, unit, "s")
        for side in SIDES:
            chart.add(*thin(x, walk.column(f"{name}_{side}")[first:last]), side)
        chart.mark(tick * walk.tick_s, text)
        parts.append(chart.text())
    return "".join(parts)


def changes(walk):
    rows = [(f"{e['tick'] * walk.tick_s:.2f} s", e["name"], e["value"], e["client"], "done" if e["done"] else "refused")
            for e in walk.of_kind("write")]
    return table(("time", "what", "to", "client", ""), rows) if rows else "<p>Nothing was changed.</p>"


def happened(walk):
    said = {"mark": lambda e: f"mark {e['number']}: {e['text']}", "emergency": lambda e: e["text"], "boot": lambda e: e["text"],
            "settled": lambda e: e["text"], "state": lambda e: e["state"] + (f": {e['fault']['name']}" if e["fault_number"] else "")}
    rows = [(f"{e['tick'] * walk.tick_s:.2f} s", said[e["kind"]](e)) for e in walk.events if e["kind"] in said]
    return table(("time", "what"), rows)


def steps_table(walk):
    from signals import SIDES
    rows = [(s["number"], f"{s['tick'] * walk.tick_s:.2f}", SIDES[s["side"]], s["speed_rad_s"], s["command_rad_s"], s["r0_m"],
             s["push_J"], s["step_s"], s["step_m"], s["speed_m_s"], s["cadence"]) for s in walk.steps[:STEPS_SHOWN]]
    head = ("step", "s", "leg", "apex rad/s", "asked for", "r0 m", "push J", "step s", "step m", "m/s", "steps/min")
    more = f"<p>The first {STEPS_SHOWN} of {len(walk.steps)} steps.</p>" if len(walk.steps) > STEPS_SHOWN else ""
    return more + table(head, rows)


def one_trial(walk):
    figures = [(name, value, unit) for name, (value, unit) in walk.figures().items()]
    symmetry = walk.symmetry()
    parameters = sorted(walk.told.get("parameters", walk.subject["parameters"]).items())
    return "".join((
        f"<h1>Trial {esc(walk.name)}</h1>", heading(walk), "<h2>In short</h2>", table(("", "", "unit"), figures),
        "<h2>By step</h2>", by_step([walk]), "<h2>Strides, averaged</h2>",
        "<p>From heel strike to heel strike; the band is one standard deviation, the number that of the strides.</p>", curves([walk]),
        "<h2>Symmetry</h2>", table(("", "left", "right", "unit", "2 (l - r) / (l + r), %"), symmetry) if symmetry else "<p>Too few steps.</p>",
        "<h2>Faults, and the five seconds around them</h2>", findings(walk), "<h2>Changes</h2>", changes(walk),
        "<h2>Events and marks</h2>", happened(walk), "<details><summary>Steps</summary>", steps_table(walk), "</details>",
        "<details><summary>Parameters at the beginning</summary>", table(("name", "value"), parameters), "</details>"))


# ---- two trials --------------------------------------------------------------------------


def two_trials(walks):
    a, b = walks
    mine, other = a.figures(), b.figures()
    rows = [(name, mine[name][0], other[name][0], mine[name][1], other[name][0] - mine[name][0]) for name in mine if name in other]
    laws = [(name, a.subject["parameters"][name], value) for name, value in b.subject["parameters"].items()
            if a.subject["parameters"].get(name) != value]
    return "".join((
        f"<h1>{esc(a.name)} and {esc(b.name)}</h1>", "<h2>In short</h2>", table(("", a.name, b.name, "unit", "difference"), rows),
        "<h2>What was set otherwise</h2>", table(("parameter", a.name, b.name), laws) if laws else "<p>Nothing.</p>",
        "<h2>By step</h2>", by_step(walks), "<h2>Strides, averaged</h2>", curves(walks),
        f"<h2>{esc(a.name)}</h2>", heading(a), findings(a), f"<h2>{esc(b.name)}</h2>", heading(b), findings(b)))


def page(walks):
    body = one_trial(walks[0]) if len(walks) == 1 else two_trials(walks)
    return (f"<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>"
            f"<title>{esc(' and '.join(walk.name for walk in walks))}</title><style>{STYLE}</style><body>{body}</body></html>\n")


def write(text, out):
    """To standard output, or whole or not at all into a file."""
    if str(out) == "-":
        sys.stdout.buffer.write(text if isinstance(text, bytes) else text.encode())
        return
    with tempfile.NamedTemporaryFile(dir=out.parent, prefix=out.name, delete=False) as stream:
        stream.write(text if isinstance(text, bytes) else text.encode())
        stream.flush()
        os.fsync(stream.fileno())
    os.chmod(stream.name, 0o644)
    os.replace(stream.name, out)


def main(arguments):
    parser = argparse.ArgumentParser(prog="afo report", description=__doc__)
    parser.add_argument("trial", nargs="+", type=pathlib.Path)
    parser.add_argument("--afo", required=True)
    parser.add_argument("--subject")
    parser.add_argument("--out", type=pathlib.Path)
    options = parser.parse_args(arguments)
    missing = missing_packages()
    if missing:
        print("\n".join(f"afo report: {text}" for text in missing), file=sys.stderr)
        return EXIT_USAGE
    import frames
    import trial
    import walkdata
    try:
        if len(options.trial) > 2:
            raise trial.TrialError("one trial, or two to compare")
        walks = [walkdata.load(one, options.afo, options.subject) for one in options.trial]
        out = options.out or options.trial[0] / ("report.html" if len(walks) == 1 else f"with-{walks[1].name}.html")
        write(page(walks), out)
    except (OSError, trial.TrialError, frames.BadLine) as error:
        print(f"afo report: {error}", file=sys.stderr)
        return EXIT_USAGE
    if str(out) != "-":
        print(out)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
