"""How long the speed takes to settle after it was asked to change: by step, from the controller's own records."""

WITHIN, STEPS, RAMP_LEFT_RAD_S = 0.02, 3, 0.0005  # of the speed asked for; so many steps in a row


class Settling:
    """Takes events, gives findings: the steps and seconds from a written speed to the first of three steps within 2 %."""

    def __init__(self, subject):
        self.tick_s = subject["tick_s"]
        self.asked = None

    def take(self, event):
        if event["kind"] == "write" and event.get("done") and event["name"] == "commands.desired_apex_speed":
            self.asked = {"tick": event["tick"], "speed": event["value"], "steps": 0, "good": [], "from": None,
                          "ramp": 0}
            return []
        if event["kind"] == "state" and event["state"] != "walking":
            asked, self.asked = self.asked, None
            return [self._broken(event, asked)] if asked and event["fault_number"] else []
        if event["kind"] != "step" or self.asked is None:
            return []
        return self._step(event, self.asked)

    def _step(self, step, asked):
        asked["steps"] += 1
        asked["from"] = asked["from"] or step["speed_rad_s"]
        asked["ramp"] += abs(step["command_rad_s"] - asked["speed"]) > RAMP_LEFT_RAD_S
        off = abs(step["speed_rad_s"] - asked["speed"]) / asked["speed"] if asked["speed"] else 1.0
        asked["good"] = asked["good"] + [(asked["steps"], step["tick"])] if off <= WITHIN else []
        if len(asked["good"]) < STEPS:
            return []
        steps, tick = asked["good"][0]
        self.asked = None
        seconds = (tick - asked["tick"]) * self.tick_s
        text = (f"the speed settled at {asked['speed']:.3f} rad/s (within 2 %) {steps} steps, {seconds:.1f} s after it was "
                f"asked for; from {asked['from']:.3f} rad/s")
        if 2 * asked["ramp"] > steps:
            text += (f". In {min(asked['ramp'], steps)} of these steps the command itself was still on its way: "
                     "speed_ramp_rad_s is its change a step. Try a larger one, half as much again at a time: with one that is too "
                     "large the steps swing about the command, and then the walker falls")
        else:
            text += ". The command was there soon: kp_m_s_rad and r0_change_max_m are what corrects the rest"
        return [{"kind": "settled", "tick": step["tick"], "steps": steps, "seconds": seconds, "speed": asked["speed"],
                 "from": asked["from"], "text": text}]

    def _broken(self, event, asked):
        """The walk ended before the speed had settled."""
        came = f"{asked['ramp']} of them with the command on its way" if asked["ramp"] else "the command was there at once"
        text = (f"the walk ended in a fault {asked['steps']} steps after {asked['speed']:.3f} rad/s was asked for, {came}. The speed "
                "was asked to change faster than this gait follows: write a smaller speed_ramp_rad_s, or a larger kp_m_s_rad within "
                "what this walker bears; then begin anew")
        return {"kind": "unsettled", "tick": event["tick"], "steps": asked["steps"], "speed": asked["speed"], "text": text}
