"""Three drive protocols under the same walk, and logs that replay to the last bit."""
import random
import re
import subprocess

import pytest

from afo import AFO, ROOT, file_of, run, walk, who, with_lines

PAPERS_DEVICES = ["virtual", "odrive", "ak80"]


@pytest.mark.parametrize("device", PAPERS_DEVICES)
def test_the_walk_works_on_each_drive_protocol(device):
    status, report = walk(*who(device=device), "--sensors", "ideal", "--speed", "0.6", "--steps", "120")
    assert status == 0 and report["fell"] is False and report["fault"] is None
    last = report["apex_speed_rad_s"][-20:]
    assert abs(sum(last) / len(last) / 0.6 - 1) < 0.002
    assert max(last) - min(last) < 0.005 * 0.6


def device_with(path, base, lines):
    return with_lines(path, file_of("devices", base), lines)


def test_a_drive_that_counts_backwards_from_elsewhere_walks_the_same_walk(tmp_path):
    options = ("--speed", "0.6", "--steps", "12", "--quiet", "--csv")
    mirrored = device_with(tmp_path / "mirrored.ini", "virtual", ["zero_counts = -123456", "direction = -1"])
    assert run(*options, tmp_path / "a.csv").returncode == 0
    assert run("--device", mirrored, *options, tmp_path / "b.csv").returncode == 0
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


@pytest.mark.parametrize("base, lines, message", [
    ("ak80", ["zero_rad = 5"], "\"zero_rad\" (motor angle at the unloaded spring): 5 rad and the stroke leave"),
    ("ak80", ["zero_rad = -12.6"], "position_range_rad, the field it is commanded in, 12.5 rad"),
    ("ak80", ["zero_counts = 3"], "does nothing with this leg's protocol"),
    ("virtual", ["rad_per_m = 60"], "does nothing with this leg's protocol"),
    ("virtual", ["direction = 0"], "1 or -1"),
    ("virtual", ["zero_counts = 0.5"], "not a whole number"),
])
def test_a_drive_that_cannot_fit_is_refused(tmp_path, base, lines, message):
    done = run("--device", device_with(tmp_path / "no.ini", base, lines), "--steps", "2")
    assert done.returncode == 2 and message in done.stderr and "no.ini" in done.stderr, done.stderr


def record(path, steps):
    done = run("--speed", "0.5", "--steps", steps, "--quiet", "--log", path)
    assert done.returncode == 0, done.stderr
    return path


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    return record(tmp_path_factory.mktemp("replay") / "walk.log", 15)


@pytest.fixture(scope="module")
def short_log(tmp_path_factory):
    return record(tmp_path_factory.mktemp("replay") / "short.log", 3)


def replay(path, *arguments):
    return run("--speed", "0.5", *arguments, path, command="replay")


@pytest.mark.parametrize("extra", ["000#8100", "390#0000000000000000"])
def test_a_frame_that_the_task_did_not_send_is_found(log, tmp_path, extra):
    """One NMT command or step frame more than the control task makes: the controller hears none of
    them itself, so that only the caller can say that another node sent it."""
    lines = log.read_text().splitlines(keepends=True)
    middle = len(lines) // 2
    stamp, interface, _ = lines[middle].split(" ")
    lines.insert(middle, f"{stamp} {interface} {extra}\n")
    changed = tmp_path / "extra.log"
    changed.write_text("".join(lines))
    done = replay(changed)
    assert done.returncode == 1 and f"line {middle + 1}," in done.stdout and extra[:3] in done.stdout, done.stdout
    assert replay(changed, "--foreign-nodes").returncode == 0


@pytest.mark.parametrize("extra", ["602#4000100000000000", "602#2300100000000000"])
def test_a_request_to_a_node_that_the_controller_did_not_hear_is_found(log, tmp_path, extra):
    """Another node's SDO request is heard, and in the digest: this one was not on the bus."""
    lines = log.read_text().splitlines(keepends=True)
    middle = len(lines) // 2
    stamp, interface, _ = lines[middle].split(" ")
    lines.insert(middle, f"{stamp} {interface} {extra}\n")
    changed = tmp_path / "extra.log"
    changed.write_text("".join(lines))
    for options in ((), ("--foreign-nodes",)):
        done = replay(changed, *options)
        assert done.returncode == 1 and extra[:3] in done.stdout, done.stdout


def test_a_log_replays_to_every_frame_of_the_controller(log):
    done = replay(log)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "reproduced" in done.stdout
    commands = sum(" 201#" in line for line in log.read_text().splitlines())
    assert commands > 10000


def test_a_report_that_cannot_be_written_is_no_success(log):
    with open("/dev/full", "w") as full:
        done = subprocess.run([AFO, "replay", "--speed", "0.5", log], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2 and "cannot write to standard output" in done.stderr


def identifier(line):
    return line.split(" ")[2].split("#")[0]


def tells_of_the_build(line):
    """The 29-bit frames at a log's beginning: which build and parameters wrote it. They were on no bus, and
    another build may replay the log: nothing follows from them."""
    return len(identifier(line)) == 8


def flip(line, bit):
    head, data = line.rsplit("#", 1)
    raw = bytearray.fromhex(data)
    raw[bit // 8] ^= 1 << (bit % 8)
    return head + "#" + raw.hex().upper()


@pytest.mark.parametrize("seed", range(12))
def test_one_changed_bit_is_found(log, tmp_path, seed):
    generator = random.Random(seed)
    lines = log.read_text().splitlines()
    # Not in the last tenth of a second, after which the controller had nothing more to say.
    candidates = [i for i in range(len(lines) - 1500) if not lines[i].endswith("#") and not tells_of_the_build(lines[i])]
    chosen = generator.choice(candidates)
    bits = 4 * len(lines[chosen].rsplit("#", 1)[1])
    lines[chosen] = flip(lines[chosen], generator.randrange(bits))
    changed = tmp_path / "changed.log"
    changed.write_text("\n".join(lines) + "\n")
    done = replay(changed)
    assert done.returncode == 1, f"{lines[chosen]} passed: {done.stdout}"
    assert "tick" in done.stdout and "line" in done.stdout



def test_every_field_of_every_frame_is_watched(short_log, tmp_path):
    """One bit of each byte of each kind of frame, of its identifier and of its length."""
    lines = short_log.read_text().splitlines()
    kinds = {}
    for i, line in enumerate(lines[:-1500]):
        if not tells_of_the_build(line):
            kinds.setdefault(identifier(line), []).append(i)
    kinds.pop("080")
    assert {"181", "182", "201", "283", "284", "290", "301", "302", "381", "382", "390", "581",
            "584", "601", "604", "701", "704", "710", "000"} <= set(kinds)
    generator = random.Random(4)
    passed = []
    for kind, places in sorted(kinds.items()):
        at = generator.choice(places)
        head, data = lines[at].rsplit("#", 1)
        other = f"{int(kind, 16) ^ 1 << generator.randrange(11):03X}"
        changes = [flip(lines[at], 8 * byte + generator.randrange(8)) for byte in range(len(data) // 2)]
        changes += [head + "#" + data[:-2], head[:-3] + other + "#" + data]
        if len(data) < 16:
            changes.append(head + "#" + data + "00")
        for change in changes:
            changed = tmp_path / "changed.log"
            changed.write_text("\n".join(lines[:at] + [change] + lines[at + 1:]) + "\n")
            done = replay(changed)
            if done.returncode != 1 or "tick" not in done.stdout:
                passed.append((lines[at], change, done.stdout))
    assert not passed


def test_what_others_said_before_the_controller_came_is_no_difference(log, tmp_path):
    lines = log.read_text().splitlines()
    alone = "(0000000000.000001) can0 {}"
    before = [alone.format(f"70{1 + i % 4}#7F") for i in range(400)]
    path = tmp_path / "late.log"
    path.write_text("\n".join(before + lines) + "\n")
    assert replay(path).returncode == 0
    # A second run behind the first one, cut off as by a kill.
    twice = lines[:50003] + before + [alone.format("710#00")] + \
        [line for line in lines if not line.endswith(" 710#00")]
    path.write_text("\n".join(twice) + "\n")
    done = replay(path)
    assert done.returncode == 0 and "in 2 runs" in done.stdout, done.stdout
    at = next(i for i in range(90000, len(twice)) if " 283#" in twice[i])
    path.write_text("\n".join(twice[:at] + [flip(twice[at], 3)] + twice[at + 1:]) + "\n")
    assert replay(path).returncode == 1


def test_a_log_from_the_middle_of_a_run_is_told_so(log, tmp_path):
    path = tmp_path / "middle.log"
    path.write_text("\n".join(log.read_text().splitlines()[30000:]) + "\n")
    done = replay(path)
    assert done.returncode == 1 and "middle of a run" in done.stdout
    silence = ["(0000000000.000001) can0 701#05"] * 600
    lines = log.read_text().splitlines()
    path.write_text("\n".join(lines[:30000] + silence + lines[30000:]) + "\n")
    done = replay(path)
    assert done.returncode == 2 and "without a SYNC" in done.stderr


def test_a_log_from_the_middle_of_a_run_replays_from_the_next_boot(log, tmp_path):
    """The run that was under way is left out, with what the old controller said last; the next one is judged to the bit."""
    lines = [line for line in log.read_text().splitlines() if not line.split(" ")[2].startswith("1AB")]
    path = tmp_path / "middle.log"
    later = [f"({float(line[1:18]) + 50:017.6f}{line[18:]}" for line in lines]  # switched on again after a pause
    joined = lines[30000:50007] + later
    path.write_text("\n".join(joined) + "\n")
    assert replay(path).returncode != 0
    done, whole = replay(path, "--from-boot"), replay(log)
    count = re.compile(r"all (\d+) frames of the controller reproduced")
    assert done.returncode == 0 and count.search(done.stdout)[1] == count.search(whole.stdout)[1], done.stdout
    at = next(i for i in range(90000, len(joined)) if " 283#" in joined[i])
    path.write_text("\n".join(joined[:at] + [flip(joined[at], 3)] + joined[at + 1:]) + "\n")
    assert replay(path, "--from-boot").returncode == 1
    path.write_text("\n".join(lines[30000:50007]) + "\n")
    done = replay(path, "--from-boot")
    assert done.returncode == 2 and "no boot-up of the controller" in done.stderr


def test_a_lost_frame_is_found(log, tmp_path):
    lines = log.read_text().splitlines()
    index = next(i for i in range(40000, len(lines)) if " 284#" in lines[i])
    shorter = tmp_path / "shorter.log"
    shorter.write_text("\n".join(lines[:index] + lines[index + 1:]) + "\n")
    assert replay(shorter).returncode == 1


@pytest.mark.parametrize("share", (0.3, 0.5, 0.7, 0.9))
def test_a_lost_target_is_found_where_it_was(log, tmp_path, share):
    """Also where the targets before and behind it are the same as it."""
    lines = log.read_text().splitlines()
    index = next(i for i in range(int(share * len(lines)), len(lines)) if " 201#" in lines[i])
    tick = sum(" 080#" in line for line in lines[:index])
    shorter = tmp_path / "shorter.log"
    shorter.write_text("\n".join(lines[:index] + lines[index + 1:]) + "\n")
    done = replay(shorter)
    assert done.returncode == 1, done.stdout
    told = [int(number) for number in re.findall(r"tick (\d+)", done.stdout)]
    assert told and abs(told[0] - tick) <= 3, (tick, done.stdout)


def test_the_ticks_that_no_digest_covers_are_told(log, tmp_path):
    lines = log.read_text().splitlines()
    last = max(i for i, line in enumerate(lines) if " 190#" in line or " 290#" in line)
    done = replay(log)
    left = re.search(r"inputs of the last (\d+) ticks .* no digest", done.stdout)
    syncs = sum(" 080#" in line for line in lines[last:])
    assert (int(left[1]) if left else 0) in range(syncs, syncs + 3), (syncs, done.stdout)


def test_other_settings_than_the_recorded_ones_are_found(log):
    done = replay(log, "--kp", "0.03")
    assert done.returncode == 1 and "missing" not in done.stdout, done.stdout
    assert "recorded with other parameters" in done.stdout, done.stdout


@pytest.mark.parametrize("seed", range(10))
def test_frames_that_the_recorder_lost_are_not_the_tasks_fault(log, tmp_path, seed):
    """A burst is missing, as when candump's receive buffer overflows in a fast lock-step run."""
    generator = random.Random(seed)
    lines = log.read_text().splitlines()
    at = generator.randrange(30000, len(lines) - 3000)
    count = generator.choice((3, 8, 30, 200, 1000))
    lost = tmp_path / "lost.log"
    lost.write_text("\n".join(lines[:at] + lines[at + count:]) + "\n")
    done = replay(lost)
    assert done.returncode == 1 and "frames are missing from the log" in done.stdout, done.stdout
    where = int(re.search(r"before line (\d+)", done.stdout)[1])
    assert at - 30 <= where <= at + 30, (at, done.stdout)


def test_candumps_own_word_that_it_lost_frames_is_passed_on(log, tmp_path):
    lines = log.read_text().splitlines()
    lines.insert(40000, "DROPCOUNT: dropped 12 CAN frames on 'can0' socket (total drops 12)")
    path = tmp_path / "dropped.log"
    path.write_text("\n".join(lines) + "\n")
    done = replay(path)
    assert done.returncode == 2 and "line 40001" in done.stderr and "lost frames" in done.stderr, done.stderr


def with_another_bus(lines, first):
    """A second CANopen bus in the log, with a master, SYNCs, targets and heartbeats of its own."""
    others = ["080#", "201#0000000000000000", "181#3712AABBCCDD", "701#05", "710#05", "283#0102030405"]
    out = []
    for i, line in enumerate(lines):
        stamp, interface, _ = line.split(" ")
        for other in others[i % 6:i % 6 + 1] if i % 3 == 0 else []:
            out.append(f"{stamp} can1 {other}")
        out.append(line)
    other_first = [f"(0000000000.000000) can1 {frame}" for frame in others] if first else []
    return other_first + out


@pytest.mark.parametrize("first", [False, True])
def test_of_two_interfaces_the_orthosis_is_found(short_log, tmp_path, first):
    path = tmp_path / "two.log"
    path.write_text("\n".join(with_another_bus(short_log.read_text().splitlines(), first)) + "\n")
    done = replay(path)
    assert done.returncode == 0 and "of interface can0, the log has 2" in done.stdout, done.stdout + done.stderr
    assert replay(path, "--interface", "can0").returncode == 0
    assert replay(path, "--interface", "can1").returncode == 1
    done = replay(path, "--interface", "can7")
    assert done.returncode == 2 and "no interface can7" in done.stderr and "can1" in done.stderr, done.stderr
    piped = subprocess.run(["bash", "-c", f"cat {path} | {AFO} replay --speed 0.5 /dev/stdin"], capture_output=True, text=True)
    assert piped.returncode == 2 and "second interface" in piped.stderr, piped.stdout + piped.stderr
    piped = subprocess.run(["bash", "-c", f"cat {path} | {AFO} replay --speed 0.5 --interface can0 /dev/stdin"],
                           capture_output=True, text=True)
    assert piped.returncode == 0, piped.stdout + piped.stderr


def test_a_log_that_python_can_wrote_replays(short_log, tmp_path):
    can = pytest.importorskip("can")
    path = tmp_path / "python.log"
    with can.CanutilsLogWriter(path) as writer:
        for message in can.CanutilsLogReader(short_log):
            message.is_rx = message.arbitration_id % 2 == 0
            writer(message)
    text = path.read_text()
    assert " T\n" in text and " R\n" in text and text.startswith("(0.")
    assert replay(path).returncode == 0
    path.write_text(text.replace("\n", "\r\n"))
    assert replay(path).returncode == 0


def test_every_form_that_candump_writes_replays(short_log, tmp_path):
    """Played with canplayer and recorded with candump, in all its forms at once."""
    lines = [line for line in short_log.read_text().splitlines() if not tells_of_the_build(line)][:3000]
    part = tmp_path / "part.log"
    part.write_text("\n".join(lines) + "\n")
    forms = {"log": "-L", "directions": "-L -x", "absolute": "-t a", "delta": "-t d", "zero": "-t z",
             "marks": "-t a -x", "ascii": "-t a -a", "date": "-t A", "bare": ""}
    dumps = "".join(f"candump {options} -r 16777216 -n {len(lines)} -T 8000 vcan0 >{tmp_path}/{name}.log & \n"
                    for name, options in forms.items())
    script = f"{dumps} sleep 1; canplayer -g 1 -I {part} vcan0=can0; wait"
    done = subprocess.run(["scripts/vcan-guest", "--timeout", "100", "--", "bash", "-c", script], cwd=ROOT,
                          capture_output=True, text=True, timeout=140)
    assert done.returncode == 0, done.stdout + done.stderr
    for name in forms:
        path = tmp_path / f"{name}.log"
        assert len(path.read_text().splitlines()) == len(lines), name
        done = replay(path)
        if name in ("date", "bare"):
            assert done.returncode == 2 and "line 1" in done.stderr and "candump -L" in done.stderr, done.stderr
        else:
            assert done.returncode == 0, (name, done.stdout, done.stderr)


def test_a_log_that_is_none_is_refused(tmp_path):
    path = tmp_path / "none.log"
    path.write_text("(0000000000.000055) can0 080#\nnonsense\n")
    done = replay(path)
    assert done.returncode == 2 and "line 2" in done.stderr
    path.write_text("")
    done = replay(path)
    assert done.returncode == 2 and "no SYNC" in done.stderr
    done = replay(tmp_path / "missing.log")
    assert done.returncode == 2 and "missing.log" in done.stderr
