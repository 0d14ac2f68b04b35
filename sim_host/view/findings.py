"""What the seconds before a fault show, in words: for who asks why a walk ended."""
import numpy as np

BEFORE_S, MISSING_S = 12.0, 1.8
SPEED_OFF, R0_JUMP = 0.1, 0.3
KNOCK_S, KNOCK_RAD_S = 0.016, 0.1


def before_fault(walk, tick):
    """Findings in order of time; walk: events, tick_s, rows_of()."""
    first = tick - BEFORE_S / walk.tick_s
    near = [event for event in walk.events if first <= event["tick"] <= tick]
    notes = []
    notes += [(e["tick"], f"{e['name']} was set to {e['value']:.6g} by client {e['client']}") for e in near
              if e["kind"] == "write" and e["done"] and isinstance(e["value"], (int, float)) and "unlock" not in e["name"]]
    notes += [(e["tick"], f"an emergency: {e['text']}") for e in near if e["kind"] == "emergency" and not e["over"]]
    notes += _earlier(walk, first)
    notes += _pushes(walk, near, tick) + _steps(walk, near) + _bus(walk, int(max(first, 0)), tick)
    off = [at for at, text in notes if "at the apex" in text]
    notes += _knock(walk, near, int(max(first, 0)), min([tick, *off]))  # behind a wrong step the body jerks as it falls
    return [f"{at * walk.tick_s:.2f} s: {text}" for at, text in sorted(notes)]


def _earlier(walk, first):
    """Parameters that somebody had set before: what is set now may be the cause, however long ago that was."""
    newest = {e["name"]: e for e in walk.events if e["kind"] == "write" and e["done"] and e["tick"] < first
              and e["name"].startswith("parameters.") and isinstance(e["value"], (int, float))}
    return [(e["tick"], f"{name} was set to {e['value']:.6g} by client {e['client']}, and is so since") for name, e in newest.items()]


def _pushes(walk, near, tick):
    strikes = [e for e in near if e["kind"] == "strike"]
    pushes = [e["tick"] for e in near if e["kind"] == "push"]
    notes = []
    for strike in strikes:
        if not any(abs(push - strike["tick"]) < 0.3 / walk.tick_s for push in pushes):
            leg = ("left", "right")[1 - strike["side"]]
            notes.append((strike["tick"], f"the {leg} leg gave no push at this heel strike"))
    if pushes and tick - pushes[-1] > MISSING_S / walk.tick_s:
        notes.append((pushes[-1], f"this was the last push, {(tick - pushes[-1]) * walk.tick_s:.1f} s before the fault"))
    return notes


def _steps(walk, near):
    notes = []
    steps = [e for e in near if e["kind"] == "step"]
    for before, step in zip(steps, steps[1:]):
        asked = step["command_rad_s"]
        off = step["speed_rad_s"] - asked
        if asked and abs(off) > SPEED_OFF * asked:
            word = "slower" if off < 0 else "faster"
            notes.append((step["tick"], f"step {step['number']}: {abs(off) / asked * 100:.0f} % {word} at the apex "
                                        f"({step['speed_rad_s']:.3f} rad/s) than asked for ({asked:.3f} rad/s)"))
        if before["r0_m"] and abs(step["r0_m"] - before["r0_m"]) > R0_JUMP * before["r0_m"]:
            notes.append((step["tick"], f"step {step['number']}: the law changed r0 from {1000 * before['r0_m']:.1f} mm to "
                                        f"{1000 * step['r0_m']:.1f} mm"))
    return notes


def _knock(walk, near, first, tick):
    """The leg that stands changes its rate by a jerk, away from heel strikes, pushes and toe-offs: somebody pushed."""
    span = int(KNOCK_S / walk.tick_s)
    first, stance = walk.rows_of("stance", first, tick)
    rates = [walk.rows_of(f"leg_rate_{side}", first, tick)[1] for side in ("left", "right")]
    rate = np.where(stance == 1, rates[1], rates[0])
    if len(rate) < 3 * span:
        return []
    jump = rate[span:] - rate[:-span]
    walks = next((e["tick"] for e in near if e["kind"] in ("step", "push")), first)
    jump[:max(walks - first, 0)] = 0.0
    usual = np.nanmedian(np.abs(jump))
    for event in near:  # what walking itself does
        if event["kind"] in ("strike", "push", "toe_off"):
            at = event["tick"] - first
            jump[max(at - 3 * span, 0):max(at + 2 * span, 0)] = 0.0
    beyond = np.flatnonzero(np.abs(jump) > max(KNOCK_RAD_S, 4 * usual))
    if len(beyond) == 0:
        return []
    place = int(beyond[0] + np.nanargmax(np.abs(jump[beyond[0]:beyond[0] + 2 * span])))  # the first one: others follow from it
    word = "backwards" if jump[place] > 0 else "forwards"
    return [(first + int(beyond[0]) + span, f"the body was jerked {word}: the leg that stands changed its rate by {abs(jump[place]):.2f} rad/s "
                            f"within {1000 * KNOCK_S:.0f} ms, without a heel strike or push-off of its own")]


def _bus(walk, first, tick):
    first, period = walk.rows_of("period", first, tick)
    lost = np.flatnonzero(period > 1500 * walk.tick_s)
    return [(first + int(lost[0]), f"{len(lost)} SYNCs came late or not at all")] if len(lost) else []
