"""A walk as a picture that moves: SVG with SMIL animations, no script; it repeats for ever in any browser."""
import bisect
import math
import statistics
import xml.sax.saxutils

FRAMES_PER_S = 25
LONGEST_S = 30.0
WIDTH, HEIGHT, GROUND = 640, 400, 360
LEG_PIXELS = 220  # of the unloaded leg
COLOURS = {"left": "#1f5fa8", "right": "#d9661f"}
MARK_M = 0.5
STRIP_HEIGHT, STRIP_S, STRIP_PERIOD_S = 250, 2.7, 0.1  # four steps of a person
# Of a person who walks by reflexes: their segments' pitch, and by the leg's length where their parts end (sim_host/reflex).
BODY = ("trunk_lean_rad", *(f"{part}_{side}_rad" for side in COLOURS for part in ("thigh", "shank", "foot")))
TRUNK, PART, HEEL, BALL = 0.6, 0.5, -0.04, 0.16
NEEDED = ("time_s", "stance", "phase", "theta_left_rad", "theta_right_rad", "ankle_left_m", "ankle_right_m", "hip_x_m", "hip_y_m")


def leg_length_m(rows, told):
    """As the file beside the table tells, else from single support: the stance leg carries the hip at l cos(pitch)."""
    length = told.get("who", {}).get("leg_length_m")
    if length:
        return float(length)
    single = [row for row in rows if row["phase"] == "single"]
    return statistics.median(row["hip_y_m"] / math.cos(row[f"theta_{row['stance']}_rad"]) for row in single or rows)


def frames_of(rows):
    """Rows at even times, FRAMES_PER_S a second, no more than LONGEST_S of them."""
    times = [row["time_s"] for row in rows]
    end = min(times[-1], times[0] + LONGEST_S)
    count = max(2, int((end - times[0]) * FRAMES_PER_S) + 1)
    return [rows[min(bisect.bisect_left(times, times[0] + i / FRAMES_PER_S), len(rows) - 1)] for i in range(count)]


def moving(attribute, values, seconds):
    text = ";".join(f"{value:.1f}" for value in values)
    return f'<animate attributeName="{attribute}" values="{text}" dur="{seconds:.3f}s" repeatCount="indefinite"/>'


def body_of(row, length):
    """A person's lines, forward and up, m, from the hip: trunk, and for each side hip, knee, ankle, heel, ball."""
    lean = row["trunk_lean_rad"]
    lines = {"trunk": [(0.0, 0.0), (TRUNK * length * math.sin(lean), TRUNK * length * math.cos(lean))]}
    for side in COLOURS:
        points = [(0.0, 0.0)]
        for part in ("thigh", "shank"):
            angle, (x, y) = row[f"{part}_{side}_rad"], points[-1]
            points.append((x + PART * length * math.sin(angle), y - PART * length * math.cos(angle)))
        angle, (x, y) = row[f"foot_{side}_rad"], points[-1]
        points += [(x + reach * length * math.cos(angle), y + reach * length * math.sin(angle)) for reach in (HEEL, BALL)]
        lines[side] = points
    return lines


def polyline(points, colour, width, inside=""):
    return (f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="{width}" stroke-linecap="round" '
            f'stroke-linejoin="round">{inside}</polyline>')


def placed(points, x, y, scale):
    return " ".join(f"{x + across * scale:.1f},{y - up * scale:.1f}" for across, up in points)


def draw_body(frames, length, scale, hip, seconds):
    """The person, moving: one line that bends at its joints for the trunk and for each leg."""
    bodies = [body_of(row, length) for row in frames]
    parts = []
    for name in ("right", "trunk", "left"):
        points = [placed(body[name], x, y, scale) for body, x, y in zip(bodies, *hip)]
        values = ";".join(points)
        parts.append(polyline(points[0], COLOURS.get(name, "#2b2f36"), 6, f'<animate attributeName="points" values="{values}" '
                              f'dur="{seconds:.3f}s" repeatCount="indefinite"/>'))
    return parts


def strip(rows, length):
    """The end of the walk as stick figures at even times, side by side."""
    last = [row for row in rows if row["time_s"] > rows[-1]["time_s"] - STRIP_S]
    every = max(1, round(STRIP_PERIOD_S / ((last[-1]["time_s"] - last[0]["time_s"]) / max(1, len(last) - 1))))
    shown = last[::every]
    way = max(1e-9, shown[0]["hip_x_m"] - shown[-1]["hip_x_m"])
    scale = min((WIDTH - 100) / way, (STRIP_HEIGHT - 40) / (1.7 * length))
    ground = HEIGHT + STRIP_HEIGHT - 20
    parts = [f'<line x1="0" y1="{ground}" x2="{WIDTH}" y2="{ground}" stroke="#2b2f36"/>']
    for row in shown:
        x, y = 50 + (shown[0]["hip_x_m"] - row["hip_x_m"]) * scale, ground - row["hip_y_m"] * scale
        body = body_of(row, length)
        parts += [polyline(placed(body[name], x, y, scale), COLOURS.get(name, "#2b2f36"), 1.2) for name in ("right", "trunk", "left")]
    return parts


def draw(rows, told):
    """The SVG of a walk. rows: of ticks, numbers but for stance and phase. Forward (-x of the model) is to the right."""
    frames = frames_of(rows)
    seconds = (len(frames) - 1) / FRAMES_PER_S
    length = leg_length_m(frames, told)
    scale = LEG_PIXELS / length
    hip_x = [-row["hip_x_m"] * scale for row in frames]
    hip_y = [GROUND - row["hip_y_m"] * scale for row in frames]
    parts = []
    marks = range(math.floor(min(hip_x) / scale / MARK_M) - 4, math.ceil(max(hip_x) / scale / MARK_M) + 5)
    for mark in marks:
        x = mark * MARK_M * scale
        parts.append(f'<line x1="{x:.1f}" y1="{GROUND}" x2="{x:.1f}" y2="{GROUND + 8}" stroke="#9aa3ad"/>'
                     f'<text x="{x:.1f}" y="{GROUND + 24}" text-anchor="middle">{mark * MARK_M:g} m</text>')
    has_body = all(name in frames[0] for name in BODY)
    if has_body:
        parts += draw_body(frames, length, scale, (hip_x, hip_y), seconds)
    for side, colour in () if has_body else COLOURS.items():
        reach = [(length + row[f"ankle_{side}_m"]) * scale for row in frames]
        angle = [row[f"theta_{side}_rad"] for row in frames]
        toe_x = [x + r * math.sin(a) for x, r, a in zip(hip_x, reach, angle)]
        toe_y = [y + r * math.cos(a) for y, r, a in zip(hip_y, reach, angle)]
        parts.append(f'<line x1="{hip_x[0]:.1f}" y1="{hip_y[0]:.1f}" x2="{toe_x[0]:.1f}" y2="{toe_y[0]:.1f}" stroke="{colour}" '
                     'stroke-width="6" stroke-linecap="round">' +
                     "".join(moving(*one, seconds) for one in (("x1", hip_x), ("y1", hip_y), ("x2", toe_x), ("y2", toe_y))) +
                     "</line>")
    parts.append(f'<circle cx="{hip_x[0]:.1f}" cy="{hip_y[0]:.1f}" r="{6 if has_body else 14}" fill="#2b2f36">' + moving("cx", hip_x, seconds) +
                 moving("cy", hip_y, seconds) + "</circle>")
    height = HEIGHT + (STRIP_HEIGHT if has_body else 0)
    ways = ";".join(f"{WIDTH / 2 - x:.1f} 0" for x in hip_x)
    name = told.get("who", {}).get("name") or "a walk"
    title = xml.sax.saxutils.escape(f"{name}: {seconds:.1f} s, {(hip_x[-1] - hip_x[0]) / scale / seconds:.2f} m/s")
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}" '
            f'role="img" font-family="sans-serif" font-size="12" fill="#2b2f36"><title>{title}</title>'
            f'<rect width="{WIDTH}" height="{height}" fill="white"/><text x="12" y="22" font-size="14">{title}</text>'
            f'<text x="12" y="42" fill="{COLOURS["left"]}">left leg</text>'
            f'<text x="70" y="42" fill="{COLOURS["right"]}">right leg</text>'
            f'<line x1="0" y1="{GROUND}" x2="{WIDTH}" y2="{GROUND}" stroke="#2b2f36"/>'
            f'<g transform="translate({WIDTH / 2 - hip_x[0]:.1f} 0)"><animateTransform attributeName="transform" '
            f'type="translate" values="{ways}" dur="{seconds:.3f}s" repeatCount="indefinite"/>' + "".join(parts) + "</g>" + "".join(strip(rows, length) if has_body else []) + "</svg>\n")
