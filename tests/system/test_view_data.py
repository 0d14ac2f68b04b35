"""What afo view makes of frames, against the plant's own table; what it records, against afo replay and other readers."""
import csv
import io
import json
import re
import subprocess
import sys

import numpy as np
import pytest

from afo import AFO, ROOT, run
from gait_play import write
from made_gait import made_gait
from viewer import Talk, viewing

VIEW = ROOT / "sim_host" / "view"
sys.path.insert(0, str(VIEW))
import frames  # noqa: E402
import signals  # noqa: E402
import trial  # noqa: E402
import walkdata  # noqa: E402
import words  # noqa: E402

STEPS = 8


@pytest.fixture(scope="module")
def who():
    """Person and device as the program gives them to its server."""
    with viewing("--replay", "/dev/null") as view:
        talk = Talk(view)
        return talk.hear()["subject"]


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """A walk's log, and the plant's table of the same ticks."""
    folder = tmp_path_factory.mktemp("walk")
    done = run("--speed", "0.8", "--steps", STEPS, "--sensors", "ideal", "--log", folder / "w.log", "--csv", folder / "w.csv",
               "--ticks", "--quiet")
    assert done.returncode == 0, done.stderr
    with open(folder / "w.csv", newline="", encoding="utf-8") as stream:
        table = list(csv.DictReader(stream))
    return folder / "w.log", table


@pytest.fixture(scope="module")
def walk(walked, who):
    return walkdata.Walk(walked[0], str(AFO), who)


def column(table, name):
    return np.array([float(row[name]) for row in table])


@pytest.mark.parametrize("signal,truth,within", [
    ("leg_angle_left", "theta_left_rad", 2e-6), ("leg_angle_right", "theta_right_rad", 2e-6),
    ("ankle_left", "ankle_left_m", 2e-5), ("ankle_right", "ankle_right_m", 2e-5),
    ("motor_left", "motor_left_m", 2e-5), ("motor_right", "motor_right_m", 2e-5)])
def test_signals_are_the_plants(walked, walk, signal, truth, within):
    """Row t holds what the nodes sampled at SYNC t: the plant's line t, which it wrote at the end of tick t."""
    expected = column(walked[1], truth)
    found = walk.column(signal)[1:len(expected)]
    from_here = 1000  # the nodes speak by then
    assert np.abs(found - expected[:len(found)])[from_here:].max() <= within


def test_events_are_the_plants(walked, walk):
    """Pushes within 2 ms of the plant's releases; toe-offs when the ankle is seen to come back; the stance is the plant's."""
    table = walked[1]
    ticks = {kind: [int(row["tick"]) for row in table if row["event"] == kind] for kind in ("release", "lift_off", "apex")}
    pushes = [event["tick"] for event in walk.of_kind("push")]
    assert len(pushes) == len(ticks["release"]) >= STEPS - 2
    assert max(abs(a - b) for a, b in zip(pushes, ticks["release"])) <= 2
    toe_offs = [event["tick"] for event in walk.of_kind("toe_off")]
    assert len(toe_offs) == len(ticks["lift_off"])
    assert max(abs(a - b) for a, b in zip(toe_offs, ticks["lift_off"])) <= 20
    found = walk.column("stance") == 1
    single = [(row["stance"] == "right", bool(found[t + 1])) for t, row in enumerate(table[:len(found) - 1])
              if t > 1002 and row["phase"] == "single"]
    assert sum(a != b for a, b in single) < 0.005 * len(single)


def test_the_hip_goes_as_far_as_the_plants(walked, walk):
    way = column(walked[1], "hip_x_m")
    first, last = 1100, len(way) - 50
    found = walk.column("hip_x")
    assert abs((found[last] - found[first]) + (way[last] - way[first])) < 0.02 * abs(way[last] - way[first])


def test_steps_are_those_of_the_plant(walk):
    """What the controller measured at each apex, beside the true speed that afo sim reports."""
    truth = json.loads(run("--speed", "0.8", "--steps", STEPS, "--sensors", "ideal", "--json", "--quiet").stdout)["apex_speed_rad_s"]
    found = [step["speed_rad_s"] for step in walk.steps]
    assert len(found) >= STEPS - 1
    assert np.abs(np.array(found) - np.array(truth[:len(found)])).max() < 0.002
    assert [step["number"] for step in walk.steps] == list(range(1, len(found) + 1))


def test_every_fault_of_the_supervisor_has_words():
    source = (ROOT / "controller/supervisor/supervisor.c").read_text(encoding="utf-8")
    part = source[source.index("*supervisor_fault_name("):]
    names = re.findall(r'"([^"]+)"', part[:part.index("};")])
    assert set(names) == set(words.FAULTS)
    assert all(what and (todo or name == "none") for name, (what, todo) in words.FAULTS.items())


@pytest.mark.parametrize("code,text", [(0x8130, "heartbeat"), (0x4310, "hot"), (0x3220, "voltage too low"), (0x8611, "following"),
                                       (0xFF10, "latched a fault"), (0x0000, "no error left"), (0x5042, "hardware")])
def test_emergencies_in_words(code, text):
    told = words.emergency(0x082, code.to_bytes(2, "little") + bytes(6))
    assert text in told["text"] and told["text"].startswith("right drive")


def test_a_log_is_written_as_it_was_read(walked):
    with open(walked[0], "rb") as stream:
        text = stream.read()
    records, interface = frames.parse_log(io.BytesIO(text))
    assert frames.log_lines(records, interface).encode() == text


@pytest.mark.parametrize("line", [b"garbage\n", b"(1.000000) can0 1234#00\n", b"(1.000000) can0 123#0\n", b"(1.0) can0 123#001122334455667788\n"])
def test_what_is_no_log_is_refused_by_its_line(line):
    with pytest.raises(frames.BadLine, match="line 2"):
        frames.parse_log(io.BytesIO(b"(0000000001.000000) can0 080#\n" + line))


def test_marks_travel_in_the_log():
    text = "Fuß rutscht, zweimal; a longer text than eight bytes"
    records = trial.mark_records(7, text, 5)
    again, _ = frames.parse_log(io.BytesIO(frames.log_lines(records).encode()))
    reader = trial.MarkReader()
    found = [reader.take(int(one["id"]), one["data"].tobytes(), int(one["length"])) for one in again]
    assert found[-1] == (7, text) and not any(found[:-1])


def test_what_was_before_a_trial_replays_with_it(walked, tmp_path):
    """Frames since the controller's start, in pieces, behind an older run; then a trial from the middle of the walk."""
    import before
    import gzip
    with open(walked[0], "rb") as stream:
        records, _ = frames.parse_log(stream)
    records = records[records["id"] < 0x800]
    older, middle = records[20000:30005].copy(), len(records) // 2
    records["time_us"] += 50000000
    past = before.Before()
    assert past.copy() is None
    past.take(older)
    assert past.copy() is None  # its controller was started before anybody watched
    for start in range(0, middle, 777):
        past.take(records[start:min(start + 777, middle)])
    packed = b"".join(past.copy())
    past.take(records[middle:])  # it goes on behind a copy
    lines, own = gzip.decompress(packed).decode().splitlines(), frames.log_lines(records[:middle]).splitlines()
    assert lines[-len(own):] == own and len(lines) - len(own) < 20  # before it: what nodes said behind the older run's last SYNC
    (tmp_path / "before.log.gz").write_bytes(packed)
    (tmp_path / "bus.log").write_text(frames.log_lines(records[middle:]), encoding="utf-8")
    subject = {"person_file": None, "device_file": None, "desired_speed_rad_s": 0.8}
    command, where = trial.how_to_replay({"subject": subject, "replay_from": trial.BEFORE_IT}, tmp_path)
    done = subprocess.run(["bash", "-o", "pipefail", "-c", command.replace("afo replay", f"{AFO} replay")], capture_output=True,
                          text=True, timeout=100, check=False)
    assert done.returncode == 0 and "reproduced" in done.stdout and "start" in where, done.stdout + done.stderr
    assert run("--speed", "0.8", "--foreign-nodes", tmp_path / "bus.log", command="replay").returncode != 0


def test_a_value_holds_until_the_next():
    rows = np.array([[1.0, np.nan], [np.nan, 2.0], [np.nan, np.nan], [3.0, np.nan]])
    signals.hold(rows)
    assert np.array_equal(rows, [[1, np.nan], [1, 2], [1, 2], [3, 2]], equal_nan=True)


def test_a_missing_package_is_named_with_its_command(tmp_path):
    (tmp_path / "aiohttp.py").write_text("raise ImportError('not here')\n")
    done = subprocess.run([sys.executable, VIEW / "serve.py", "--afo", AFO, "--subject", "{}"], capture_output=True, text=True,
                          env={"PYTHONPATH": str(tmp_path), "PATH": "/usr/bin:/bin"}, timeout=60)
    assert done.returncode == 2
    assert "aiohttp is missing" in done.stderr and "scripts/setup view" in done.stderr and "apt-get install" in done.stderr


def test_writes_of_tools_that_take_turns_are_told_apart(tmp_path):
    """One tool's read between another's write and its answer; an answer of abort; the client of the key."""
    import hub
    from objects import Objects
    watch = hub.SdoWatch(Objects(str(AFO), ROOT / "hal/canopen/eds/controller.eds"))
    key, write = bytes.fromhex("2300200573657407"), bytes.fromhex("23102007")
    assert watch.take(0x610, key) is None
    assert watch.take(0x590, bytes.fromhex("6000200500000000"))["client"] == 7
    assert watch.take(0x610, write + np.float32(0.045).tobytes()) is None
    assert watch.take(0x610, bytes.fromhex("4020200100000000")) is None  # a read of another tool
    assert watch.take(0x590, bytes.fromhex("4320200100000000")) is None
    event = watch.take(0x590, bytes.fromhex("6010200700000000"))
    assert (event["name"], event["value"], event["client"], event["done"]) == ("parameters.kp_m_s_rad", 0.045, 7, True)
    assert watch.take(0x590, bytes.fromhex("6010200700000000")) is None
    watch.take(0x610, write + np.float32(9).tobytes())
    refused = watch.take(0x590, bytes.fromhex("8010200731000906"))
    assert (refused["done"], refused["abort"], refused["value"]) == (False, 0x06090031, 9)


def test_a_push_by_somebody_is_found_before_the_fault():
    """Made rows: the standing leg is jerked at 1.8 s, and no push follows."""
    class Past:
        tick_s = 0.001

        def __init__(self):
            rate = np.full(3000, -0.5)
            rate[1800:] += 0.3
            self.columns = {"stance": np.zeros(3000), "leg_rate_left": rate, "leg_rate_right": rate, "period": np.ones(3000)}
            self.events = [{"kind": "push", "tick": 100, "side": 0}]

        def rows_of(self, name, first, last):
            return first, self.columns[name][first:last].copy()
    from findings import before_fault
    notes = before_fault(Past(), 2900)
    jerk = [note for note in notes if "jerked backwards" in note]
    assert jerk and abs(float(jerk[0].split(" s:")[0]) - 1.8) < 0.02
    assert any("last push" in note for note in notes)


def state(tick, name, fault=0):
    return {"kind": "state", "tick": tick, "state": name, "fault_number": fault}


def step(tick, speed, command):
    return {"kind": "step", "tick": tick, "speed_rad_s": speed, "command_rad_s": command}


def asked_for(speed):
    return {"kind": "write", "tick": 100, "done": True, "name": "commands.desired_apex_speed", "value": speed}


def test_a_speed_settles_at_the_first_of_three_steps_within_two_percent():
    from settling import Settling
    watch = Settling({"tick_s": 0.001})
    made = [asked_for(0.45), step(1000, 0.55, 0.53), step(2000, 0.50, 0.45), step(3000, 0.458, 0.45), step(4000, 0.47, 0.45),
            step(5000, 0.442, 0.45), step(6000, 0.451, 0.45)]
    assert [found for one in made for found in watch.take(one)] == []
    found = watch.take(step(7000, 0.45, 0.45))
    assert [(one["kind"], one["steps"], one["seconds"], one["from"]) for one in found] == [("settled", 5, 4.9, 0.55)]
    assert watch.take(step(8000, 0.45, 0.45)) == []


def test_a_walk_that_falls_before_its_speed_has_settled_is_told_why():
    from settling import Settling
    watch = Settling({"tick_s": 0.001})
    for one in (asked_for(0.45), step(1000, 0.55, 0.50), step(2000, 0.32, 0.45), step(3000, 0.57, 0.45)):
        assert watch.take(one) == []
    found = watch.take(state(4000, "unloading", 7))
    assert found[0]["kind"] == "unsettled" and "3 steps after 0.450 rad/s" in found[0]["text"] and "speed_ramp_rad_s" in found[0]["text"]
    assert watch.take(state(5000, "FAULT", 7)) == []
    watch.take(asked_for(0.4))
    assert watch.take(state(6000, "unloading")) == []  # somebody stopped it: no fault


def test_a_setting_of_long_ago_is_among_what_was_seen_before_a_fault():
    class Past:
        tick_s = 0.001
        events = [{"kind": "write", "tick": 5000 + i, "done": True, "client": 101, "name": "parameters.speed_ramp_rad_s", "value": value}
                  for i, value in enumerate((0.01, 0.02))]

        def rows_of(self, name, first, last):
            return first, np.zeros(last - first)
    from findings import before_fault
    notes = [note for note in before_fault(Past(), 60000) if "speed_ramp_rad_s" in note]
    assert len(notes) == 1 and "set to 0.02" in notes[0] and notes[0].startswith("5.00 s")


def test_a_recorded_persons_events_are_the_feet_of_the_recording(tmp_path):
    """A made walk of a person: strikes by the foot switches, in their number and cadence; pushes of both legs."""
    path = write(tmp_path / "made.csv", made_gait())
    person, device = ROOT / "sim_host/persons/adult70.ini", ROOT / "sim_host/devices/exo50.ini"
    more = ("--person", person, "--device", device)
    done = run("--recording", path, *more, "--switches", "exact", "--log", tmp_path / "p.log", "--quiet")
    assert done.returncode in (0, 1), done.stderr
    with viewing("--replay", tmp_path / "p.log", *more) as view:
        who = Talk(view).hear()
    with open(path, newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    down = {side: np.array([float(row[f"contact_{side}"]) for row in rows]) for side in "lr"}
    landings = sum(int(np.sum(np.diff(one) > 0)) for one in down.values())
    strikes = [event for event in who["events"] if event["kind"] == "strike"]
    assert landings > 20 and abs(len(strikes) - landings) <= 4 and {event["sign"] for event in strikes[4:]} == {"switch"}
