"""afo itself: its commands, their help, what it says to mistyped names, its exit statuses, and what it leaves beside a
table."""
import csv
import json
import re
import subprocess

import pytest

from afo import AFO, ROOT, run

COMMANDS = ("sim", "compare", "study", "faults", "soak", "replay", "view", "report", "import", "export", "walker", "host", "ctl", "commission", "blackbox", "update", "settings", "size", "device", "eds", "pil", "g474", "slcan")
STUDIES = ("fixed-point", "continue", "doublings", "bifurcation", "basin", "gain", "noise", "map", "atlas", "laws",
           "latch", "dose", "observe", "observer-gains", "tune-person", "validate-person", "table", "page")
DEVICE_COMMANDS = ("check", "show", "keys", "frames", "import", "convert")
ALL = ([(name,) for name in COMMANDS if name not in ("study", "device")] + [("study", name) for name in STUDIES] +
       [("device", name) for name in DEVICE_COMMANDS])


def afo(*words, **options):
    return subprocess.run([AFO, *map(str, words)], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120,
                          **options)


def listed(text):
    return re.findall(r"^  ([a-z][a-z0-9-]*) {2,}\S", text, re.M)


def test_the_lists_are_whole():
    assert listed(afo("help").stdout) == list(COMMANDS)
    assert listed(afo("study", "help").stdout) == list(STUDIES)
    assert listed(afo("device", "help").stdout) == list(DEVICE_COMMANDS)
    for words in (("help",), ("--help",)):
        done = afo(*words)
        assert done.returncode == 0 and not done.stderr
        assert done.stdout == afo("help").stdout
    nothing = afo()
    assert nothing.returncode == 2 and nothing.stderr == afo("help").stdout and not nothing.stdout


@pytest.mark.parametrize("words", ALL, ids=" ".join)
def test_every_command_has_the_same_help_and_version(words):
    done = afo(*words, "--help")
    name = " ".join(("afo", *words))
    assert done.returncode == 0 and not done.stderr
    assert re.match(rf"Usage: {name} ", done.stdout)
    assert "--help" in done.stdout and "--version" in done.stdout and "--usage" in done.stdout
    assert afo("help", *words).stdout == done.stdout
    version = afo(*words, "--version")
    assert version.returncode == 0 and not version.stderr
    assert version.stdout == afo("--version").stdout.replace("afo ", f"{name} ", 1)
    assert max(map(len, done.stdout.splitlines())) <= 80


@pytest.mark.parametrize("words", [(), *ALL], ids=lambda words: " ".join(words) or "afo")
def test_help_that_is_lost_is_told(words):
    for option in ("--help", "--version"):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([AFO, *words, option], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
        assert done.returncode == 2
        assert done.stderr.count("cannot write to standard output: No space left on device") == 1


@pytest.mark.parametrize("words, said", [
    (("smi",), 'afo: no command "smi"; nearest: sim\n'),
    (("help", "studdy"), 'afo: no command "studdy"; nearest: study\n'),
    (("qqqq",), 'afo: no command "qqqq"\n'),
    (("study", "fixedpoint"), 'afo study: no study "fixedpoint"; nearest: fixed-point\n'),
    (("study", "laws", "jumsp"), 'afo study laws: no study "jumsp"; nearest: jumps; see --help\n'),
    (("sim", "--spede", 3), 'afo sim: no option "--spede"; nearest: --speed\n'),
    (("sim", "--spede=3"), 'afo sim: no option "--spede"; nearest: --speed\n'),
    (("walker", "--can", "vcan0", "--sensers", "ideal"), 'afo walker: no option "--sensers"; nearest: --sensors\n'),
    (("study", "basin", "--point", 3, "--vloume"), 'afo study basin: no option "--vloume"; nearest: --volume\n'),
    (("sim", "--law", "predictve"), "; nearest: predictive\n"),
    (("sim", "--k", 0.5), "--person FILE, --device FILE"),
    (("sim", "--m=0.2"), "--person FILE, --device FILE"),
    (("sim", "--sensors", "17bits"), "nearest: 17bit\n"),
    (("sim", "--fault", "swaped"), "nearest: swapped\n"),
    (("pil", "--fault", "hangs"), "nearest: hang\n"),
    (("soak", "--inject", "leek"), "nearest: leak\n"),
    (("faults", "--run", 999999999), "--run: \"999999999\" is not a whole number from 0 to 9999999\n"),
])
def test_a_mistyped_name_is_answered_by_the_nearest(words, said):
    done = afo(*words)
    assert done.returncode == 2 and not done.stdout
    assert said in done.stderr, done.stderr


def test_the_value_of_an_option_is_not_taken_for_one():
    done = afo("sim", "--person", "--nowhere", "--steps", 3)
    assert done.returncode == 2 and "no option" not in done.stderr and "--nowhere" in done.stderr
    done = afo("sim", "--law", "person", "--steps", 0)  # the law of a recorded person is a name as others are
    assert done.returncode == 2 and "--law" not in done.stderr and "--steps" in done.stderr


def test_a_fault_that_does_not_exist_is_answered_by_the_list():
    done = afo("faults", "--only", "nosuch")
    assert done.returncode == 2 and not done.stdout
    people = afo("faults", "--people", "--only", "nosuch")
    assert people.returncode == 2 and not people.stdout
    both, of_people = (ROOT / "sim_host/faults/fault_kinds.h").read_text().split("#define PEOPLE_FAULT_TABLE")
    names = [re.findall(r'^    X\(\w+,\s+"([^"]+)"', table, re.M) for table in (both, of_people)]
    assert all(names)
    for name in names[0]:
        assert f"  {name}\n" in done.stderr and f"  {name}\n" in people.stderr
    for name in names[1]:
        assert f"  {name}\n" not in done.stderr and f"  {name}\n" in people.stderr
    few = afo("faults", "--only", "push", "--runs", 3)
    assert few.returncode == 2 and "  push (with more --runs)\n" in few.stderr


def test_a_law_in_a_person_file_that_is_none_is_answered_by_the_list(tmp_path):
    person = tmp_path / "somebody.ini"
    person.write_text((ROOT / "sim_host/persons/paper.ini").read_text() + "\n[prescription]\nlaw = predictve\n")
    done = afo("sim", "--person", person)
    assert done.returncode == 2
    assert "allowed is proportional, open-loop, " in done.stderr and "; nearest: predictive" in done.stderr
    person.write_text(person.read_text().replace("predictve", "predictive"))
    assert run("--person", person, "--steps", 3, "--quiet").returncode == 0


def test_a_table_has_its_whole_experiment_beside_it(tmp_path):
    table = tmp_path / "steps.csv"
    done = run("--speed", "0.45", "--law", "dlqr", "--sensors", "14bit", "--seed", 7, "--steps", 6, "--slope-deg", "0.1",
               "--fault", "swapped", "--fault-step", 4, "--sensor-noise", "0.5", "--csv", table, "--json")
    told = json.loads((tmp_path / "steps.csv.json").read_text())
    assert told["program"] == "afo sim"
    assert f"afo {told['version']} (build {told['build_id']})\n" == afo("--version").stdout
    assert told["arguments"][:2] == ["--speed", "0.45"] and str(table) in told["arguments"]
    assert told["who"]["name"] and told["who"]["leg_length_m"] == 1 and told["who"]["recording"] is None
    assert told["law"] == "dlqr" and told["target_speed_rad_s"] == 0.45 and told["seed"] == 7
    assert told["sensors"]["preset"] == "14bit" and told["sensors"]["left"]["angle_noise_counts"] == 0.5
    assert told["injected_fault"] == {"name": "swapped", "after_step": 4, "and_ms": 0}
    assert told["ground"] == {"slope_deg": 0.1, "terrain_mm": 0} and told["push"]["impulse_Ns"] == 0
    assert json.loads(done.stdout)["experiment"] == told
    assert table.read_text().startswith("step,time_s,")


def test_a_fault_runs_table_names_its_experiment(tmp_path):
    done = afo("faults", "--run", 7, "--seed", 3, "--csv", tmp_path / "ticks.csv")
    told = json.loads((tmp_path / "ticks.csv.json").read_text())
    assert told["run"] == 7 and told["seed"] == 3 and told["version"]
    assert f"({told['scene']}): {told['faults'][0]['name']}" in done.stdout


def test_a_pipe_gets_a_table_and_no_file(tmp_path):
    done = run("--steps", 3, "--quiet", "--csv", "/dev/stdout", cwd=tmp_path)
    assert done.returncode == 0 and len(done.stdout.splitlines()) == 4
    assert not list(tmp_path.iterdir())


def test_json_is_json_without_a_single_number_to_tell():
    done = run("--steps", 1, "--json", "--fault", "cut-drives", "--fault-step", 0)
    report = json.loads(done.stdout, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))
    assert report["steps"] <= 1


def test_a_recordings_table_has_the_recordings_own_clock(person, tmp_path):
    with open(person, newline="", encoding="utf-8") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    strikes = [b["time_s"] for a, b in zip(rows, rows[1:]) if not a["contact_l"] and b["contact_l"]]
    done = run("--recording", person, "--quiet", "--json", "--ticks", "--csv", tmp_path / "ticks.csv")
    assert done.stdout
    with open(tmp_path / "ticks.csv", newline="", encoding="utf-8") as file:
        ticks = list(csv.DictReader(file))
    told = [float(tick["time_s"]) for tick in ticks if tick["event"] == "heel_strike"]
    for strike in strikes[1:-1]:  # the table's events are both legs'
        assert min(abs(time - strike) for time in told) < 0.006
    assert run("--recording", person, "--quiet", "--csv", tmp_path / "steps.csv").returncode in (0, 1)
    with open(tmp_path / "steps.csv", newline="", encoding="utf-8") as file:
        steps = [float(row["time_s"]) for row in csv.DictReader(file) if row["side"] == "left"]
    seen = json.loads(done.stdout)["left"]["apex_s"]
    for apex in seen[1:-1]:
        assert min(abs(time - apex) for time in steps) < 0.1
