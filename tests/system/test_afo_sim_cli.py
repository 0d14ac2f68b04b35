"""afo sim's command line: output files, exit statuses, and what it says to bad input."""
import csv
import json
import re
import signal
import subprocess
import time

import pytest

from afo import AFO, ROOT, STEP_COLUMNS, TICK_COLUMNS, file_of, run, with_lines

SHORT = ("--speed", "0.42", "--steps", "8", "--sensors", "ideal", "--quiet")


def test_help_names_every_flag():
    done = run("--help")
    assert done.returncode == 0 and not done.stderr
    for flag in ("--speed", "--steps", "--open-loop", "--r0", "--kp", "--sensors", "--person", "--device", "--seed",
                 "--csv", "--ticks", "--log", "--quiet", "--json", "--recording", "--help", "--version"):
        assert flag in done.stdout, flag


def test_version():
    done = run("--version")
    assert done.returncode == 0 and not done.stderr
    assert re.search(r"\d+\.\d+\.\d+", done.stdout)


def test_quiet_says_nothing():
    done = run(*SHORT)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_json_is_one_object_on_standard_output():
    done = run(*SHORT, "--json")
    result = json.loads(done.stdout)
    assert done.returncode == 0
    for key in ("fell", "fault", "steps", "target_speed_rad_s", "apex_speed_rad_s", "r0_m", "bus_load",
                "simulated_s"):
        assert key in result, key
    assert result["steps"] == len(result["apex_speed_rad_s"]) == len(result["r0_m"]) == 8


def test_a_report_a_person_can_read():
    done = run("--speed", "0.42", "--steps", "8", "--sensors", "ideal")
    assert done.returncode == 0
    assert "speed" in done.stdout and "r0" in done.stdout
    # No terminal, no progress line.
    assert "\r" not in done.stdout + done.stderr and "\033" not in done.stdout + done.stderr


def read_csv(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return rows[0], rows[1:]


def test_csv_by_step(tmp_path):
    done = run(*SHORT, "--json", "--csv", tmp_path / "steps.csv")
    header, rows = read_csv(tmp_path / "steps.csv")
    result = json.loads(done.stdout)
    assert header == STEP_COLUMNS
    assert len(rows) == 8
    column = {name: [row[i] for row in rows] for i, name in enumerate(header)}
    assert [float(v) for v in column["apex_speed_rad_s"]] == pytest.approx(result["apex_speed_rad_s"], rel=1e-6)
    assert [float(v) for v in column["r0_m"]] == pytest.approx(result["r0_m"], rel=1e-6)
    assert len(set(column["side"])) == 2
    assert all(a != b for a, b in zip(column["side"], column["side"][1:]))
    times = [float(v) for v in column["time_s"]]
    assert all(b > a for a, b in zip(times, times[1:]))


def test_csv_by_tick(tmp_path):
    assert run(*SHORT, "--csv", tmp_path / "ticks.csv", "--ticks").returncode == 0
    header, rows = read_csv(tmp_path / "ticks.csv")
    assert header[:len(TICK_COLUMNS)] == TICK_COLUMNS
    assert all(len(row) == len(header) for row in rows)
    times = [float(row[1]) for row in rows]
    assert len(rows) > 4000  # eight steps of about a second
    assert all(b - a == pytest.approx(1e-3, abs=1e-9) for a, b in zip(times, times[1:]))


LOG_LINE = re.compile(r"^\((\d+\.\d{6})\) (\S+) ([0-9A-F]{3}|[0-9A-F]{8})#((?:[0-9A-F]{2}){0,8}|R\d?)$")
NOTE_LINE = re.compile(r"\(\d+\.\d{6}\) can0 1AB00[01][0-9A-F]{2}#([0-9A-F]*)$")


def frame_table():
    """Identifier -> data bytes, read from the header that the code is built from."""
    text = (ROOT / "hal" / "bus" / "frame_table.h").read_text(encoding="utf-8")
    return {int(identifier, 16): int(length)
            for identifier, length in re.findall(r"X\(\w+, (0x[0-9A-Fa-f]+), (\d),", text)}


def test_log_is_candump_format_and_keeps_the_frame_table(tmp_path):
    assert run(*SHORT, "--log", tmp_path / "walk.log").returncode == 0
    lengths = frame_table()
    previous, syncs, notes = -1.0, [], []
    for line in (tmp_path / "walk.log").read_text().splitlines():
        if NOTE_LINE.match(line):  # who recorded it, before the first frame
            assert previous == -1.0
            notes.append(bytes.fromhex(NOTE_LINE.match(line)[1]))
            continue
        match = LOG_LINE.match(line)
        assert match, line
        time, identifier = float(match[1]), int(match[3], 16)
        assert time >= previous
        previous = time
        assert identifier in lengths, line
        if not 0x580 <= identifier < 0x680 and identifier != 0x000:
            assert len(match[4]) == 2 * lengths[identifier], line
        if identifier == 0x080:
            syncs.append(time)
    periods = [b - a for a, b in zip(syncs, syncs[1:])]
    assert len(syncs) > 4000
    assert sum(periods) / len(periods) == pytest.approx(1e-3, rel=1e-4)
    assert max(periods) < 1.2e-3 and min(periods) > 0.8e-3
    # afo sim VERSION (build ID)
    version = run("--version").stdout.strip()
    assert f"(build {int.from_bytes(notes[0][:4], 'little'):08x})" in version
    assert f" {b''.join(notes[1:]).decode()} " in version


def test_same_seed_same_log_other_seed_other_log(tmp_path):
    logs = []
    for number, seed in enumerate((11, 11, 12)):
        path = tmp_path / f"{number}.log"
        run("--speed", "0.42", "--steps", "6", "--sensors", "17bit", "--quiet", "--seed", seed, "--log", path)
        logs.append(path.read_bytes())
    assert len(logs[0]) > 100000
    assert logs[0] == logs[1]
    assert logs[0] != logs[2]


@pytest.mark.parametrize("arguments,words", [
    (["--no-such-flag"], ["--no-such-flag"]),
    (["duplicate_id_count"], ["duplicate_id_count"]),
    (["--speed"], ["--speed"]),
    (["--speed", "fast"], ["--speed", "fast"]),
    (["--speed", "nan"], ["--speed"]),
    (["--speed", "0.5x"], ["--speed", "0.5x"]),
    (["--speed", "-0.5"], ["--speed"]),
    (["--speed", "50"], ["--speed"]),
    (["--steps", "0"], ["--steps"]),
    (["--steps", "-3"], ["--steps"]),
    (["--steps", "1e99"], ["--steps"]),
    (["--seed", "x"], ["--seed"]),
    (["--kp", "inf"], ["--kp"]),
    (["--open-loop", "--r0", "-0.1"], ["--r0"]),
    (["--open-loop", "--r0", "7"], ["--r0"]),
    (["--sensors", "perfect"], ["--sensors", "perfect", "17bit"]),
    (["--person", "/no/such/file.ini"], ["/no/such/file.ini"]),
    (["--device", "/no/such/file.ini"], ["/no/such/file.ini"]),
    (["--subject", "old.ini"], ["afo device convert old.ini PERSON.ini DEVICE.ini"]),
    (["--recording", "/no/such/file.csv"], ["/no/such/file.csv"]),
    (["--csv", "/no/such/folder/x.csv"], ["/no/such/folder/x.csv"]),
    (["--log", "/no/such/folder/x.log"], ["/no/such/folder/x.log"]),
    (["--csv", ""], ["no file name"]),
    (["--csv", "folder/"], ["folder/", "no file name"]),
    (["--csv", "same", "--log", "same"], ["--csv", "--log", "same file"]),
    (["--fault-step", "3"], ["--fault-step", "--fault"]),
    (["--rate", "100"], ["--rate", "--recording"]),
    (["--recording", "w.csv", "--slope-deg", "3"], ["--slope-deg", "--recording"]),
    (["--recording", "w.csv", "--terrain-mm", "50"], ["--terrain-mm", "--recording"]),
    (["--recording", "w.csv", "--push", "100@1"], ["--push", "--recording"]),
    (["--recording", "w.csv", "--law", "predictive"], ["--law", "--recording"]),
    (["--law", "dlqr", "--kp", "0.5"], ["--kp", "dlqr"]),
    (["--law", "deadbeat", "--kp", "0.5"], ["--kp", "deadbeat"]),
    (["--push", "20000@1"], ["--push", "-10000 to 10000 N s"]),
    (["--push", "0@1"], ["--push", "but 0"]),
    (["--push", "1@-1"], ["--push", "0 to 1e+06 s"]),
    (["--csv", "-"], ["\"-\"", "/dev/stdout"]),
    (["--column", "time="], ["--column", "--recording"]),
    (["--open-loop", "--r0", "0.35"], ["0.35", "allows"]),
    (["--start-r0", "0.5"], ["0.5", "allow"]),
    (["--speed", "1.18", "--law", "dlqr"], ["1.18", "this law"]),
])
def test_bad_arguments(arguments, words):
    done = run("--steps", "5", *arguments)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) <= 4
    for word in words:
        assert word in done.stderr


def paper(room):
    return file_of(room, {"persons": "paper", "devices": "virtual"}[room]).read_text(encoding="utf-8")


BOTH = pytest.mark.parametrize("option, room, key", [("--person", "persons", "torso_mass_kg"),
                                                     ("--device", "devices", "spring_N_per_m")])


@BOTH
@pytest.mark.parametrize("value,what", [
    ("-1", "allowed"), ("0", "allowed"), ("1e30", "allowed"), ("nan", ""), ("heavy", ""), ("", ""), ("1 2", ""),
])
def test_bad_value_in_a_file_names_key_and_line(tmp_path, option, room, key, value, what):
    lines = paper(room).splitlines()
    number = next(i for i, line in enumerate(lines) if re.match(rf"\s*{key}\s*=", line))
    lines[number] = f"{key} = {value}"
    path = tmp_path / "bad.ini"
    path.write_text("\n".join(lines) + "\n")
    done = run(*SHORT, option, path, "--csv", tmp_path / "out.csv")
    assert done.returncode == 2
    assert f'"{key}"' in done.stderr
    assert f"bad.ini:{number + 1}:" in done.stderr
    if what:  # what is allowed: a range of two numbers
        assert re.search(r"allowed is [\d.]+ to [\d.e+]+", done.stderr)
    assert not (tmp_path / "out.csv").exists()


@BOTH
@pytest.mark.parametrize("line", ["unheard_of = 1", "no equals sign", "[unfinished", "= 3"])
def test_malformed_file_is_refused(tmp_path, option, room, key, line):
    path = tmp_path / "bad.ini"
    path.write_text(paper(room) + line + "\n")
    done = run(*SHORT, option, path)
    assert done.returncode == 2 and key
    assert f"bad.ini:{len(path.read_text().splitlines())}:" in done.stderr


@BOTH
def test_a_key_given_twice_is_refused(tmp_path, option, room, key):
    path = tmp_path / "bad.ini"
    path.write_text(re.sub(rf"(?m)^({key} = .*)$", r"\1\n\1", paper(room)))
    done = run(*SHORT, option, path)
    assert done.returncode == 2
    assert f'"{key}"' in done.stderr and "twice" in done.stderr


@pytest.mark.parametrize("option,room,old,new,words", [
    ("--device", "devices", "spring_N_per_m = 100", "spring_N_per_m = 100000", ["spring_N_per_m", "56.2 to 625"]),
    ("--device", "devices", "spring_N_per_m = 100", "spring_N_per_m = 20", ["spring_N_per_m", "56.2 to 625"]),
    ("--device", "devices", "stroke_max_m = 0.35", "stroke_max_m = 0.01", ["0.01", "SEA"]),
    ("--person", "persons", "leg_length_m", "[prescription]\nr0_max_m = 0.39\n[person]\nleg_length_m",
     ["0.39", "stroke_max_m", "0.35"]),
    ("--person", "persons", "leg_length_m", "[prescription]\nkp_m_s_rad = 0.1\nkp_m_s_rad = 0.2\n[person]\nleg_length_m",
     ["kp_m_s_rad", "twice"]),
    ("--person", "persons", "leg_length_m", "[prescription]\nspeed_rad_s = 3\n[person]\nleg_length_m",
     ["speed_rad_s 3", "this walker"]),
    ("--device", "devices", "protocol = cia402", "protocol = cia402\nprotocol = mit", ["twice"]),
    ("--device", "devices", "protocol = cia402", "protocol = cia403", ["none, cia402, cansimple or mit", "nearest: cia402"]),
    ("--device", "devices", "counts_per_m = 13107200", "counts_per_m = 1000", ["counts_per_m", "30000"]),
])
def test_numbers_that_do_not_fit_together_are_refused(tmp_path, option, room, old, new, words):
    """Each alone may be in range; the file is named and what would be allowed."""
    path = tmp_path / "bad.ini"
    assert old in paper(room)
    path.write_text(paper(room).replace(old, new, 1))
    done = run("--steps", "5", option, path) if "speed_rad_s" in new else run(*SHORT, option, path)
    assert done.returncode == 2
    for word in ("bad.ini", *words):
        assert word in done.stderr, done.stderr


@pytest.mark.parametrize("lines,words", [
    (["r0_max_m = 0.2", "r0_ceiling_m = 0.1"],
     "r0_max_m 0.2 m is above what is locked for this person, r0_ceiling_m 0.1 m"),
    (["r0_change_max_m = 0.05", "r0_change_ceiling_m = 0.01"],
     "r0_change_max_m 0.05 m is above what is locked for this person, r0_change_ceiling_m 0.01 m"),
    (["kp_m_s_rad = 0.1", "kp_high_m_s_rad = 0.05"],
     "kp_m_s_rad 0.1 lies outside what is locked for this person"),
])
def test_what_is_locked_is_refused_in_the_same_words(tmp_path, lines, words):
    """Simulation, host, emulator and the board's settings: one validator."""
    person = with_lines(tmp_path / "locked.ini", file_of("persons", "paper"), lines, "prescription")
    said = set()
    for command in (["sim", "--steps", "3"], ["host", "--can", "none"], ["pil", "--steps", "3"],
                    ["settings", str(tmp_path / "out.bin")]):
        done = subprocess.run([AFO, *command, "--person", person], capture_output=True, text=True, check=False)
        assert done.returncode == 2 and words in done.stderr, (command, done.stderr)
        said.add(done.stderr.strip().split(": ", 1)[1])
    assert len(said) == 1, said
    assert not (tmp_path / "out.bin").exists()


@pytest.mark.parametrize("device,stays", [("ak80", True), ("virtual", False)])
def test_springs_that_nothing_unloads_are_in_the_report(device, stays):
    """A device that says unload = none: text and JSON say so, of both legs."""
    walk = ("--speed", "0.42", "--steps", "3", "--device", ROOT / f"sim_host/devices/{device}.ini")
    assert ("link loss  NOT SAFE" in run(*walk).stdout) == stays
    drives = json.loads(run(*walk, "--quiet", "--json").stdout)["drives"]
    assert [drives[leg]["loaded_without_link"] for leg in ("left", "right")] == [stays, stays]
    assert drives["push_share"] == 1 and not drives["withdrawn"] and drives["withdrawn_for"] is None


def test_a_speed_beyond_the_actuator_is_refused(tmp_path):
    """0.8 rad/s takes 0.17 m of spring, which this stroke does not have; the gait of 95 % of it walks at 0.571."""
    path = tmp_path / "short.ini"
    path.write_text(paper("devices").replace("stroke_max_m = 0.35", "stroke_max_m = 0.1", 1))
    done = run("--speed", "0.8", "--steps", "5", "--device", path)
    assert done.returncode == 2
    assert re.search(r"from 0\.12\d+ to 0\.571\d* rad/s", done.stderr), done.stderr


def test_the_prescribed_speed_is_walked(tmp_path):
    person = with_lines(tmp_path / "slow.ini", file_of("persons", "paper"), ["speed_rad_s = 0.43"], "prescription")
    report = json.loads(run("--person", person, "--steps", "3", "--quiet", "--json").stdout)
    assert report["target_speed_rad_s"] == pytest.approx(0.43, rel=1e-6)


@pytest.mark.parametrize("option,room,key", [
    ("--person", "persons", "torso_mass_kg"), ("--person", "persons", "leg_mass_kg"),
    ("--person", "persons", "leg_length_m"), ("--device", "devices", "protocol"), ("--device", "devices", "spring_N_per_m"),
    ("--device", "devices", "drive_node"), ("--device", "devices", "latch"), ("--device", "devices", "stroke_max_m"),
])
def test_a_file_without_what_has_to_be_said_is_refused(tmp_path, option, room, key):
    """What is missing is not filled in from somebody else's body or device."""
    path = tmp_path / "bad.ini"
    path.write_text(re.sub(rf"^{key} = .*\n", "", paper(room), flags=re.MULTILINE))
    done = run(*SHORT, option, path)
    assert done.returncode == 2
    assert f'"{key}"' in done.stderr and "bad.ini" in done.stderr and "allowed" in done.stderr


@pytest.mark.parametrize("option", ["--person", "--device"])
@pytest.mark.parametrize("content", [b"", b"\x00\xff\xfe" * 100, b"[person]\ntorso_mass_kg\x00 = 1\n",
                                     b"torso_mass_kg = 1\n", b"k" * 100000],
                         ids=["empty", "binary", "nul", "no section", "one long line"])
def test_a_file_that_is_none_is_refused(tmp_path, option, content):
    path = tmp_path / "bad.ini"
    path.write_bytes(content)
    done = run(*SHORT, option, path)
    assert done.returncode == 2
    assert "bad.ini" in done.stderr


def test_no_partial_file_is_left_behind(tmp_path):
    """One output can be written, the other not: neither is there afterwards."""
    done = run(*SHORT, "--csv", tmp_path / "good.csv", "--log", tmp_path / "absent" / "bad.log")
    assert done.returncode == 2
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_noticed():
    """/dev/full takes the open and refuses the write."""
    done = run(*SHORT, "--csv", "/dev/full", "--ticks")
    assert done.returncode == 2
    assert "/dev/full" in done.stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupted_walk_keeps_its_steps_beside_the_old_file(tmp_path, number):
    """Up to the step it has come to, the part is the longer walk's own beginning."""
    (tmp_path / "steps.csv").write_text("the old one\n")
    (tmp_path / "steps.csv.part").write_text("an older part\n")
    with subprocess.Popen([AFO, "sim", "--steps", "1000000", "--quiet", "--csv", tmp_path / "steps.csv",
                           "--log", tmp_path / "walk.log"], stderr=subprocess.PIPE, text=True) as walk:
        while walk.poll() is None and sum(path.stat().st_size for path in tmp_path.glob("walk.log.*")) < 2_000_000:
            time.sleep(0.05)  # some steps
        walk.send_signal(number)
        _, said = walk.communicate(timeout=30)
    assert walk.returncode == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["steps.csv", "steps.csv.part", "walk.log.part"]
    assert (tmp_path / "steps.csv").read_text() == "the old one\n"
    kept = (tmp_path / "steps.csv.part").read_text().splitlines()
    steps = int(re.search(r"broken off: its (\d+) steps are in \S+/steps\.csv\.part", said)[1])
    assert steps > 3 and len(kept) == steps + 1 and f"its {steps} steps are in {tmp_path}/walk.log.part" in said
    run("--steps", str(steps), "--quiet", "--csv", tmp_path / "whole.csv", "--log", tmp_path / "whole.log")
    # The last step's record may still have been on its way.
    assert (tmp_path / "whole.csv").read_text().splitlines()[:steps] == kept[:steps]
    whole, part = ((tmp_path / name).read_text() for name in ("whole.log", "walk.log.part"))
    assert part.endswith("\n")
    common = min(len(whole), len(part)) - 1000
    assert common > 10000 and whole[:common] == part[:common]


def test_a_reader_that_goes_away_ends_the_walk(tmp_path):
    """And the log, which would be a part only, does not appear."""
    with subprocess.Popen([AFO, "sim", "--steps", "1000000", "--quiet", "--ticks", "--csv", "/dev/stdout", "--log",
                           tmp_path / "walk.log"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as walk:
        walk.stdout.readline()
        walk.stdout.close()
        said = walk.stderr.read()
        assert walk.wait(timeout=30) == 2
    assert "/dev/stdout" in said
    assert list(tmp_path.iterdir()) == []


def test_a_push_that_never_came_is_told():
    done = run("--speed", "0.42", "--steps", "1", "--quiet", "--push", "0.01@1000")
    assert done.returncode == 2 and "--push did not happen" in done.stderr


def test_the_law_open_loop_is_answered_by_its_option():
    done = run("--law", "open-loop")
    assert done.returncode == 2 and "--open-loop --r0" in done.stderr, done.stderr


def test_help_names_every_law_that_is_taken():
    allowed = run("--law", "magic").stderr.split("allowed is ")[1].split("\n")[0].replace(" or ", ", ").split(", ")
    text = " ".join(run("--help").stdout.split())
    listed = text.split("--law=NAME ")[1].split(" --")[0]
    assert len(allowed) >= 5 and "open-loop" not in allowed
    for law in allowed:
        assert law in listed, law


def person(path, text, start=b""):
    body = file_of("persons", "paper").read_bytes()
    path.write_bytes(start + body.replace(b"name = paper's walker", b"name = A;B #1   ; a comment") + text)
    return path


def test_a_name_keeps_its_signs_and_a_byte_order_mark_is_read_over(tmp_path):
    done = run("--person", person(tmp_path / "a.ini", b"\n[prescription]; as it is\nengage_steps = 0 # none\n",
                                  start=b"\xef\xbb\xbf"), "--steps", "1", "--speed", "0.42")
    assert done.returncode == 0, done.stderr
    assert "A;B #1" in done.stdout and "comment" not in done.stdout


@pytest.mark.parametrize("text, start, words", [
    (b"\n[prescription]\nbody = 0.5\n", b"", ["body", "whole number"]),
    (b"\n[prescription]\nengage_steps = 2.5\n", b"", ["engage_steps", "whole number"]),
    (b"\n[sea]\nstroke_max_m = 0.3\n", b"", ["[sea]", "[person], [prescription], [muscles]"]),
    (b"", b"torso_mass_kg = 1\n", ['"torso_mass_kg"', "before the first [section]"]),
])
def test_persons_that_are_refused(tmp_path, text, start, words):
    done = run("--person", person(tmp_path / "a.ini", text, start), "--steps", "1")
    assert done.returncode == 2
    for word in words:
        assert word in done.stderr


def test_the_report_names_law_and_fault():
    done = run("--speed", "0.42", "--steps", "1", "--law", "dlqr", "--fault", "swapped", "--fault-step", "50")
    assert done.returncode == 2 and "--fault did not happen" in done.stderr
    assert "dlqr" in done.stdout and "eq. (16)" not in done.stdout
    assert re.search(r"swapped after step 50: not reached", done.stdout)
    assert "walked 1 step\n" in done.stdout
