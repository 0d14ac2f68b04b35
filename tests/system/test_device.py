"""afo device: files that fit, files that do not, and old files made into new ones."""
import re

import pytest

from afo import ROOT, file_of, run, who, with_lines

SHIPPED = sorted(path.stem for path in (ROOT / "sim_host/devices").glob("*.ini"))


def device(*arguments):
    return run(*arguments, command="device")


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_devices_fit_and_say_how_they_are_wired(name):
    path = file_of("devices", name)
    done = device("check", path)
    assert done.returncode == 0 and ": fits\n" in done.stdout, done.stderr
    text = path.read_text(encoding="utf-8")
    assert "; Wiring:" in text and re.search(r"; (It idealises|What it cannot do):", text)


def test_a_device_without_a_latch_that_reports_is_for_the_bench():
    assert "bench only" in device("check", file_of("devices", "ak80")).stdout
    assert "bench only" not in device("check", file_of("devices", "virtual")).stdout
    assert "not safe on link loss" in device("check", file_of("devices", "odrive")).stdout


def test_a_device_is_checked_for_a_person(tmp_path):
    wearer = with_lines(tmp_path / "person.ini", file_of("persons", "paper"), ["body = 1", "engage_steps = 4"], "prescription")
    loaded = with_lines(tmp_path / "loaded.ini", file_of("devices", "virtual"), ["unload = none"])
    for path, words in ((file_of("devices", "odrive"), ["left leg", "\"latch\"", "bench only"]),
                        (loaded, ["left leg", "\"unload\"", "none leaves the spring loaded", "bench only"]),
                        (file_of("devices", "virtual-adult"), ["spring_N_per_m", "7000", "does not suit this body"])):
        done = device("check", path, "--person", wearer)
        assert done.returncode == 1 and not done.stdout, done.stdout
        for word in words:
            assert word in done.stderr, done.stderr
    assert device("check", loaded).returncode == 0
    assert "fits, with" in device("check", file_of("devices", "virtual"), "--person", wearer).stdout
    assert "/nowhere" in device("check", loaded, "--person", "/nowhere").stderr


@pytest.mark.parametrize("person", ("adult70", "reflex-new"))
def test_a_person_without_a_device_is_told_of_one(person):
    plant = ("--plant", "reflex") if person.startswith("reflex") else ()
    done = run("--person", file_of("persons", person), *plant, "--steps", 3, "--quiet")
    assert done.returncode == 2 and "no device was named" in done.stderr and "--device sim_host/devices/" in done.stderr


def test_a_person_is_refused_on_a_device_for_the_bench(tmp_path):
    person = with_lines(tmp_path / "person.ini", file_of("persons", "paper"), ["body = 1", "engage_steps = 4"], "prescription")
    done = run("--person", person, "--device", file_of("devices", "odrive"), "--steps", "1")
    assert done.returncode == 2 and "left leg" in done.stderr and "bench only, not for a person" in done.stderr
    assert "\"latch\"" in done.stderr


@pytest.mark.parametrize("name", SHIPPED)
def test_what_is_shown_is_the_same_device(tmp_path, name):
    shown = device("show", file_of("devices", name)).stdout
    (tmp_path / "again.ini").write_text(shown, encoding="utf-8")
    assert device("show", tmp_path / "again.ini").stdout == shown
    for line in file_of("devices", name).read_text(encoding="utf-8").splitlines():
        key = line.split(";")[0].strip()
        assert key in shown, key


def test_every_key_is_listed_with_its_object():
    text = device("keys").stdout
    rows = re.findall(r"^(\w+) +0x(20\d\d):(\w\w)  ", text, re.M)
    assert len(rows) > 40 and len({row[1:] for row in rows}) == len(rows)
    assert re.search(r"^torque_constant_Nm_A +\[plant\] +0.0001 to 10 N m/A; has to be said", text, re.M)
    assert {"0x2050": "tick_us", "0x2051": "protocol"} == {f"0x{i}": n for n, i, s in rows if s == "01"}


@pytest.mark.parametrize("lines, section, words", [
    (["leg_sensor_node = 3"], "right", ["right leg", "leg_sensor_node", "3", "number of another unit"]),
    (["gear = 3"], "plant", ["[plant]", "unknown key", "gear"]),
    (["supply_V = 24"], "plant", ["motor_inertia_kg_m2", "is missing", "kg m^2"]),
    (["backlash = 3"], "both", ["unknown key \"backlash\""]),
    (["lacks = scaling, nothing_of_the_kind"], "both", ["nothing_of_the_kind", "is unknown"]),
    (["leg_sensor_object = 0x20"], "both", ["leg_sensor_object", "0x2101:00"]),
    (["spring_N_per_m = 120"], "right", ["right leg", "spring_N_per_m", "120 N/m", "which is 100 N/m"]),
])
def test_what_does_not_fit_is_told_in_words(tmp_path, lines, section, words):
    keys = "|".join(line.split(" =")[0] for line in lines)
    kept = re.sub(rf"(?<=\[right\])(.*?)^({keys}) = [^\n]*\n", r"\1", file_of("devices", "virtual").read_text(), flags=re.S | re.M)
    path = tmp_path / "some.ini"
    path.write_text("\n".join([kept, f"[{section}]", *lines]) + "\n")
    done = device("check", path)
    assert (done.returncode == 0) == (not words), done.stderr
    for word in words:
        assert word in done.stderr, done.stderr


OLD = """; an old file
[subject]
name = somebody
[walker]
M = 65
m = 2.5
l = 0.93
k = 7000
[sea]
stroke_max_m = 0.33
[drive]
zero_counts = -5
direction = -1
[ankle]
kind = lever
lever_m = 0.45
[controller]
law = dlqr
kp_m_s_rad = 0.1
"""


def test_an_old_file_becomes_a_person_and_a_device(tmp_path):
    old, person, made = (tmp_path / name for name in ("old.ini", "person.ini", "device.ini"))
    old.write_text(OLD)
    assert device("convert", old, person, made).returncode == 0
    said = person.read_text() + made.read_text()
    for line in ("name = somebody", "torso_mass_kg = 65", "leg_length_m = 0.93", "law = 2 ", "kp_m_s_rad = 0.1 ",
                 "spring_N_per_m = 7000", "stroke_max_m = 0.33", "zero_counts = -5", "direction = -1", "ankle = lever",
                 "ankle_lever_m = 0.45", "rated_force_N = 2278.5", "force_max_N = 5775"):
        assert line in said, line
    done = run("--person", person, "--device", made, "--steps", "2", "--quiet")
    assert done.returncode == 0, done.stderr


def test_an_old_file_that_was_wrong_is_refused(tmp_path):
    (tmp_path / "old.ini").write_text(OLD.replace("\nl = 0.93", "\nl = 93"))
    done = device("convert", tmp_path / "old.ini", tmp_path / "a", tmp_path / "b")
    assert done.returncode == 1 and "old.ini:7" in done.stderr and not (tmp_path / "a").exists()


def test_persons_and_devices_are_chosen_apart():
    done = run(*who("adult70", "virtual"), "--steps", "2")
    assert done.returncode == 2 and "spring_N_per_m" in done.stderr and "does not suit this body" in done.stderr
