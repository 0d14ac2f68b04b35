"""Drives that obey a data sheet strictly, set up by what they offer: they walk, or are refused by name.

The sheets are made here out of the virtual drive's own; the makers' are used where AFO_DATA holds them (eds/).
"""
import os
import pathlib
import re
import subprocess

import pytest

from afo import BUILD, ROOT, file_of, run, with_lines

WALK = ("--speed", "0.5", "--steps", "20", "--sensors", "ideal", "--quiet")
OWN = ROOT / "hal/canopen/eds/drive-left.eds"
DATA = pathlib.Path(os.environ.get("AFO_DATA", "/nowhere")) / "eds"


def sheet(path, without=(), read_only=(), unmappable=(), dummies=True, replace=()):
    """The virtual drive's data sheet with less in it."""
    sections = re.split(r"(?m)^(?=\[)", OWN.read_text(encoding="utf-8"))
    kept = []
    for section in sections:
        name = section[1:section.index("]")] if section.startswith("[") else ""
        if any(name == index or name.startswith(f"{index}sub") or name == index for index in without):
            continue
        if name in read_only:
            section = re.sub(r"AccessType=rww?", "AccessType=ro", section)
        if name in unmappable:
            section = section.replace("PDOMapping=1", "PDOMapping=0")
        if name == "DummyUsage" and not dummies:
            section = re.sub(r"=1", "=0", section)
        for place, old, new in replace:
            if name == place:
                assert old in section, (name, section)
                section = section.replace(old, new)
        kept.append(section)
    path.write_text("".join(kept), encoding="utf-8")
    return path


def imported(folder, eds, base="cia402", lines=()):
    """A device file made of a shipped one with what the import says of the sheet."""
    done = run("import", eds, command="device")
    assert done.returncode == 0, done.stderr
    told = [line for line in done.stdout.splitlines() if line.startswith(("mode = ", "lacks = "))]
    return with_lines(folder / "imported.ini", file_of("devices", base), [*told, *lines])


BARE = dict(without=["6007", "605A", "6066", "6079", "6080", "608F", "6091", "6092", "1400sub5", "6076", "2100"], dummies=False)


@pytest.mark.parametrize("what", [
    dict(),                                                 # the virtual drive itself
    dict(dummies=False),                                    # a target frame of its own
    dict(without=["1400sub5"]),                             # no time-out of its targets
    dict(without=["60FE"]),                                 # no outputs
    dict(without=["6077"], unmappable=["6079"]),            # nothing slow to tell but a temperature
    dict(without=["6077", "6079", "2100"]),                 # nothing at all
    dict(read_only=["605B", "605C", "605E"], dummies=False),
    BARE,
], ids=lambda what: ", ".join([*what.get("without", []), *(["no dummies"] if "dummies" in what else [])]) or "whole")
def test_a_drive_walks_by_what_it_offers(tmp_path, what):
    eds = sheet(tmp_path / "drive.eds", **what)
    done = run("--device", imported(tmp_path, eds), "--drive-eds", eds, *WALK)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_drive_with_interpolated_position_only_walks(tmp_path):
    eds = sheet(tmp_path / "drive.eds", replace=[("6502", "=128", "=64")])
    device = imported(tmp_path, eds)
    assert "mode = interpolated" in device.read_text()
    assert run("--device", device, "--drive-eds", eds, *WALK).returncode == 0


@pytest.mark.parametrize("what, words", [
    (dict(replace=[("6502", "=128", "=37")]), ["0x6502", "0x25", "neither cyclic synchronous position"]),
    (dict(without=["6041"]), ["0x6041, the statusword"]),
    (dict(unmappable=["6064"]), ["0x6064, the position, in a TPDO"]),
    (dict(without=["1017"]), ["0x1017, a heartbeat"]),
    (dict(replace=[("1000", "=0x20192", "=0x20191")]), ["0x1000", "no drive"]),
])
def test_a_drive_that_cannot_be_used_is_refused_by_name(tmp_path, what, words):
    done = run("import", sheet(tmp_path / "drive.eds", **what), command="device")
    assert done.returncode == 1 and not done.stdout
    for word in ["cannot be used", *words]:
        assert word in done.stderr, done.stderr


@pytest.mark.parametrize("what, words", [
    (dict(without=["6007"]), ["0x6007:00 (reaction to a lost link)", "it has no such object", "lacks = abort_option"]),
    (dict(without=["1400sub5"]), ["0x1400:05 (time-out of its targets)", "no such sub-index", "lacks = rpdo_timer"]),
    (dict(dummies=False), ["0x1600:02 (0x0004:00 in a PDO)", "cannot be mapped", "lacks = dummy"]),
    (dict(read_only=["605A"]), ["0x605A:00 (quick stop reaction)", "can only be read", "lacks = option_codes"]),
    (dict(without=["6092"]), ["0x6092:01 (scale)", "counts_per_m"]),
], ids=lambda what: str(what)[:40])
def test_what_the_file_does_not_say_is_refused_in_words(tmp_path, what, words):
    """The virtual device's file says that the drive has everything."""
    done = run("--drive-eds", sheet(tmp_path / "drive.eds", **what), *[word for word in WALK if word != "--quiet"])
    assert done.returncode == 1
    for word in ["left drive, node 1, refused", *words]:
        assert word in done.stdout, done.stdout[-600:]


@pytest.mark.parametrize("name, base", [("maxon_EPOS4_6150h.eds", "epos4"), ("maxon_EPOS4_6850h.eds", "epos4"),
                                        ("ros2_cia402_slave.eds", "cia402"), ("pilz_PRBT.dcf", "cia402"),
                                        ("technosoft_iPOS.eds", "cia402")])
@pytest.mark.data
def test_makers_drives_walk_by_their_own_data_sheets(tmp_path, name, base):
    eds = DATA / name
    assert eds.is_file(), f"AFO_DATA holds no eds/{name}"
    done = run("--device", imported(tmp_path, eds, base), "--drive-eds", eds, *WALK)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.data
def test_a_maker_s_drive_without_a_position_mode_is_refused():
    done = run("import", DATA / "faulhaber_MCLM3002.eds", command="device")
    assert done.returncode == 1 and "0x6502 (supported drive modes) is 0x25" in done.stderr


MIRRORED = """[both]
spring_N_per_m = 100
stroke_max_m = 0.35
speed_max_m_s = 1.9
force_max_N = 90
counts_per_m = 13107200
rated_force_N = 35
latch = board
latch_object = 0x2101:00
[left]
protocol = cia402
drive_node = 9
direction = -1
zero_counts = 123456
latch_node = 21
leg_sensor_node = 5
leg_direction = -1
leg_zero_rad = 1.5
[right]
protocol = cansimple
turns_per_m = 200
drive_node = 2
direction = -1
zero_turns = 7
latch_node = 22
leg_sensor_node = 4
ankle_direction = -1
ankle_zero_m = 0.01
"""
ALONE = re.sub(r"protocol = cansimple.*latch_node = 22\n", "protocol = none\n", MIRRORED, flags=re.S)


def speeds(device, *options):
    table = device.parent / "steps.csv"
    done = run("--device", device, *WALK, "--csv", table, *options)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = table.read_text().splitlines()[1:]
    assert len(rows) == 20
    return [float(row.split(",")[3]) for row in rows]


def test_unlike_legs_walk_the_walk_of_like_ones(tmp_path):
    """Mirror images, unlike zeros and numbers, a CiA 402 drive left and an ODrive right, each with a latch board."""
    device = tmp_path / "mirrored.ini"
    device.write_text(MIRRORED, encoding="utf-8")
    assert speeds(device) == pytest.approx(speeds(with_lines(tmp_path / "like.ini", file_of("devices", "virtual"), [])), rel=2e-3)


@pytest.mark.parametrize("text", [MIRRORED, ALONE], ids=["mirrored", "one drive alone"])
def test_the_log_of_any_device_replays(tmp_path, text):
    device, log = tmp_path / "device.ini", tmp_path / "walk.log"
    device.write_text(text, encoding="utf-8")
    run("--device", device, "--speed", "0.5", "--steps", "2", "--quiet", "--log", log)
    # One drive alone does not walk the paper's walker; what was tried is in the part.
    log = log if log.exists() else tmp_path / "walk.log.part"
    done = subprocess.run([BUILD / "afo", "replay", "--device", device, "--speed", "0.5", log], capture_output=True,
                          text=True, timeout=240, cwd=ROOT, check=False)
    assert done.returncode == 0 and "reproduced" in done.stdout, done.stdout + done.stderr


@pytest.mark.data
def test_one_drive_alone_helps_a_recorded_person(tmp_path):
    device = tmp_path / "alone.ini"
    device.write_text(ALONE, encoding="utf-8")
    recording = pathlib.Path(os.environ["AFO_DATA"]) / "gait_young.csv"
    done = run("--recording", recording, "--device", device, "--quiet", "--json")
    assert done.returncode == 0, done.stderr


def budget(name, *options):
    table = run("frames", file_of("devices", name), command="device").stdout
    return subprocess.run([ROOT / "scripts/bus-budget", "--frames", "-", "--bitrate", "1000000", *options], input=table,
                          capture_output=True, text=True, check=False, cwd=ROOT)


@pytest.mark.parametrize("name", sorted(path.stem for path in (ROOT / "sim_host/devices").glob("*.ini")))
def test_the_bus_of_a_shipped_device_holds_or_its_file_says_at_which_tick(name):
    """With an emergency in the same cycle, too."""
    text = file_of("devices", name).read_text()
    told = re.search(r"; The bus holds a tick of (\d+) us beside an emergency, and of (\d+) us without one", text)
    for tick, options in zip(told.groups(), (["--emergencies", "1"], [])):
        done = budget(name, *options)
        slowest = re.search(r"they hold with a SYNC every (\d+) us", done.stdout)
        assert tick == ("1000" if done.returncode == 0 else slowest[1]), (name, done.stdout[-300:])
        assert budget(name, *options, "--tick-us", tick).returncode == 0


def test_the_virtual_device_s_frames_are_the_frame_table():
    told = set(re.findall(r"X\(\w+, (0x\w+), (\d+), ([\w()]+), ([\w()]+), (\d+), (\w)\)", run("frames", command="device").stdout))
    table = (ROOT / "hal/bus/frame_table.h").read_text().split("#define FRAME_OPTIONAL_TABLE")[0]
    every = set(re.findall(r"X\(\w+, (0x\w+), (\d+), ([\w()]+), ([\w()]+), (\d+), (\w)\)", table))
    assert told == {row for row in every if row[-1] != "O"}  # without what is optional
