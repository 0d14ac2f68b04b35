"""afo import: files of gait laboratories become the recording that was in them, with its events to the sample."""
import json
import subprocess
import sys

import can
import numpy as np
import pytest

import walk_files
from afo import AFO, data, run, walk
from gait_play import read, write
from made_gait import made_gait
from walk_files import columns

PEOPLE = {"made": None, "young": "gait_young.csv", "middle": "people/gait_middle.csv", "loop": "people/child_a_loop_3.csv",
          "plates": "people/plates_a.csv"}
ANGLE_DEG = 0.02
SECONDS = 14.0


def person(name, folder):
    """(path, columns) of the first seconds of a person's walk."""
    rows = made_gait() if PEOPLE[name] is None else read(data(PEOPLE[name]))
    rows = [row for row in rows if row["time_s"] < SECONDS]
    path = write(folder / f"{name}.csv", rows)
    return path, columns(read(path))


def imported(path, out, *arguments, status=0):
    done = run(path, "--out", out, *arguments, command="import")
    assert done.returncode == status, done.stdout + done.stderr
    return columns(read(out)), done.stdout


def edges(values):
    return np.flatnonzero(np.diff(values))


def same_walk(found, truth, angle_deg=ANGLE_DEG, ankles=True):
    assert len(found["time_s"]) == len(truth["time_s"])
    assert np.abs(found["time_s"] - truth["time_s"] - (found["time_s"][0] - truth["time_s"][0])).max() < 1e-4
    for key in truth:
        if key.startswith(("thigh", "shank", "ankle")[:3 if ankles else 2]):
            assert np.abs(found[key] - truth[key]).max() < angle_deg, key
    for side in "lr":
        expected, got = edges(truth[f"contact_{side}"]), edges(found[f"contact_{side}"])
        assert len(got) == len(expected), side
        assert np.abs(got - expected).max(initial=0) <= 1, side


def same_events(found, truth, step_s):
    """What the controller finds in the two recordings: to a sample."""
    arguments = ("--switches", "exact")
    first, second = walk("--recording", truth, *arguments)[1], walk("--recording", found, *arguments)[1]
    for leg in ("left", "right"):
        for event in ("heel_strike_s", "toe_off_s", "apex_s", "recorded_heel_strike_s", "recorded_toe_off_s"):
            a, b = np.array(first[leg][event]), np.array(second[leg][event])
            assert len(a) == len(b) and len(a) > 5, (leg, event)
            shift = read_start(found) - read_start(truth)
            assert np.abs(b - a - shift).max() <= step_s + 1e-9, (leg, event)


def read_start(path):
    return float(path.read_text(encoding="ascii").splitlines()[1].split(",")[0])


def c3d_events(folder, truth):
    return walk_files.c3d(folder / "walk.c3d", truth), ()


def c3d_plates(folder, truth):
    return walk_files.c3d(folder / "plates.c3d", truth, with_events=False, with_plates=True), ()


def trc_and_forces(folder, truth):
    return (walk_files.trc(folder / "walk.trc", truth),
            ("--forces", walk_files.forces(folder / "grf.mot", truth)))


def mot_and_forces(folder, truth):
    grf = walk_files.forces(folder / "grf.mot", truth, sides=("ground_force_r_", "ground_force_l_"))
    return walk_files.joints(folder / "ik.mot", truth), ("--forces", grf)


def sto_in_radians(folder, truth):
    grf = walk_files.forces(folder / "grf.sto", truth, sides=("ground_force_1_", "ground_force_2_"))
    return walk_files.joints(folder / "ik.sto", truth, unit="rad", knee=1.0), ("--forces", grf)


def german(folder, truth):
    return walk_files.german_table(folder / "export.txt", truth), ()


def tabs_in_radians(folder, truth):
    lines = ["Timestamp\tLeftThigh\tRightThigh\tLeftShank\tRightShank\tlAnkle\trAnkle\tLeft Foot Contact\tRight Foot Contact"]
    keys = ["thigh_l_deg", "thigh_r_deg", "shank_l_deg", "shank_r_deg", "ankle_l_deg", "ankle_r_deg"]
    for i, time_s in enumerate(truth["time_s"]):
        fields = [f"{time_s:.4f}", *(f"{np.radians(truth[key][i]):.7f}" for key in keys)]
        lines.append("\t".join(fields + [f"{255 * truth[f'contact_{side}'][i]:.0f}" for side in "lr"]))
    path = folder / "imu.tsv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-16")
    return path, ()


FORMATS = [c3d_events, c3d_plates, trc_and_forces, mot_and_forces, sto_in_radians, german, tabs_in_radians]
REAL = list(zip(FORMATS, ("young", "middle", "loop", "young", "middle", "young", "loop")))


@pytest.mark.parametrize("make,name", [(make, "made") for make in FORMATS] +
                         [pytest.param(make, name, marks=pytest.mark.data) for make, name in REAL],
                         ids=lambda value: getattr(value, "__name__", value))
def test_a_file_of_each_format_is_the_walk_that_was_put_into_it(make, name, tmp_path):
    original, truth = person(name, tmp_path)
    path, options = make(tmp_path, truth)
    found, told = imported(path, tmp_path / "out.csv", *options)
    same_walk(found, truth)
    assert "look like those of a walk" in told
    if name != "made":
        same_events(tmp_path / "out.csv", original, np.median(np.diff(truth["time_s"])))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return person("made", tmp_path_factory.mktemp("made"))[1]


def test_what_was_taken_for_what_is_told_and_kept(made, tmp_path):
    path = walk_files.c3d(tmp_path / "walk.c3d", made)
    _, told = imported(path, tmp_path / "out.csv")
    for words in ("LHJC to LKNE", "RKNE to RANK", "up is +z", "towards +x", "heel strikes", "afo sim --recording",
                  "ankle neutral unknown: 0 assumed"):
        assert words in told
    kept = json.loads((tmp_path / "out.csv.json").read_text())
    digest = subprocess.run(["sha256sum", path], capture_output=True, text=True, check=True).stdout.split()[0]
    assert kept["source_sha256"] == {str(path): digest}
    assert kept["taken_from"]["thigh_l"] == "LHJC to LKNE"


def test_without_out_nothing_is_written(made, tmp_path):
    path = walk_files.table(tmp_path / "walk.csv", made)
    done = run(path, command="import")
    assert done.returncode == 0 and "written    nothing" in done.stdout
    assert list(tmp_path.iterdir()) == [path]


def negative(values):
    return -values


@pytest.mark.parametrize("change,words", [
    ({"shank_l_deg": negative}, "the left shank's sign is reversed (--reverse shank_l)"),
    ({"thigh_r_deg": negative}, "the right thigh's sign is reversed (--reverse thigh_r)"),
    ({"shank_l_deg": negative, "thigh_l_deg": negative}, "the left knee bends backwards"),
], ids=lambda value: value if isinstance(value, str) else None)
@pytest.mark.parametrize("name", ["made", pytest.param("young", marks=pytest.mark.data),
                                  pytest.param("loop", marks=pytest.mark.data)])
def test_a_reversed_sign_is_named_and_can_be_mended(name, change, words, tmp_path):
    _, truth = person(name, tmp_path)
    path = walk_files.table(tmp_path / "walk2.csv", truth, changed=change)
    _, told = imported(path, tmp_path / "out.csv", status=1)
    assert words in told
    assert told.count("check      ") == 1
    mend = [word for key in change for word in ("--reverse", key[:-4])]
    found, _ = imported(path, tmp_path / "out.csv", *mend)
    same_walk(found, truth)


@pytest.mark.parametrize("part", ["thigh", "shank", "contact"])
@pytest.mark.parametrize("name", ["made", pytest.param("middle", marks=pytest.mark.data),
                                  pytest.param("loop", marks=pytest.mark.data)])
def test_swapped_sides_are_named_and_can_be_mended(name, part, tmp_path):
    _, truth = person(name, tmp_path)
    unit = "" if part == "contact" else "_deg"
    left, right = f"{part}_l{unit}", f"{part}_r{unit}"
    path = walk_files.table(tmp_path / "walk2.csv", truth, names={left: right, right: left})
    _, told = imported(path, tmp_path / "out.csv", status=1)
    assert f"left and right {part} look swapped (--swap {part})" in told
    assert told.count("check      ") == 1
    found, _ = imported(path, tmp_path / "out.csv", "--swap", part)
    same_walk(found, truth)


def test_angles_in_another_unit_are_named(made, tmp_path):
    path = walk_files.table(tmp_path / "walk.csv", made, changed={key: np.radians for key in made if key.endswith("_deg")})
    _, told = imported(path, tmp_path / "out.csv", status=1)  # the names say deg
    assert "are these angles in radians? (--angles rad)" in told
    same_walk(imported(path, tmp_path / "out.csv", "--angles", "rad")[0], made)


def test_the_ankles_neutral_is_subtracted(made, tmp_path):
    path = walk_files.table(tmp_path / "walk.csv", made)
    found, told = imported(path, tmp_path / "out.csv", "--ankle-neutral", "-4.5")
    assert np.abs(found["ankle_l_deg"] - made["ankle_l_deg"] - 4.5).max() < 1e-3
    assert "neutral unknown" not in told


def test_short_gaps_are_filled_and_long_ones_cut(made, tmp_path):
    def holes(values):
        values = values.copy()
        values[1000:1010] = np.nan  # 0.05 s
        values[400:440] = np.nan    # 0.2 s
        return values
    path = walk_files.table(tmp_path / "walk.csv", made, changed={"shank_l_deg": holes})
    found, told = imported(path, tmp_path / "out.csv")
    assert "filled: 1 of shank_l; the longest was 0.055 s" in told
    assert "cut: gaps over 0.1 s leave 0.00 to 2.00 s, 2.20 to" in told and "kept is part 2" in told
    assert found["time_s"][0] == pytest.approx(2.2) and len(found["time_s"]) == len(made["time_s"]) - 440
    line = np.interp(made["time_s"][1004], made["time_s"][[999, 1010]], made["shank_l_deg"][[999, 1010]])
    assert found["shank_l_deg"][1004 - 440] == pytest.approx(line, abs=1e-3)
    first, _ = imported(path, tmp_path / "out.csv", "--part", "1")
    assert len(first["time_s"]) == 400
    whole, _ = imported(path, tmp_path / "out.csv", "--longest-gap", "0.3")
    assert len(whole["time_s"]) == len(made["time_s"])
    assert run(path, "--part", "3", command="import").stderr.endswith("--part 3: the gaps leave 2 parts\n")


def test_missing_lines_are_gaps_too(made, tmp_path):
    keep = [i for i in range(len(made["time_s"])) if not 300 <= i < 310]
    path = walk_files.table(tmp_path / "walk.csv", made, rows=keep)
    found, told = imported(path, tmp_path / "out.csv")
    assert len(found["time_s"]) == len(made["time_s"]) and "filled: 1 of thigh_l" in told


def test_a_marker_that_hides_is_filled_or_cut(made, tmp_path):
    path = walk_files.c3d(tmp_path / "walk.c3d", made, hidden=[("LKNE", 500, 512), ("RTOE", 100, 200)])
    found, told = imported(path, tmp_path / "out.csv")
    assert "1 of thigh_l, 1 of shank_l" in told and "cut: gaps over 0.1 s" in told
    assert found["time_s"][0] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("names,options,words", [
    ({"shank_l_deg": "schank_l"}, (), "no column for shank_l; found are time_s,"),
    ({"shank_l_deg": "schank_l"}, (), "the nearest: schank_l"),
    ({"shank_l_deg": "schank_l"}, (), "tell which is which: --column shank_l=NAME"),
    ({}, ("--column", "thigh_l=Upper"), "--column thigh_l=Upper: no such column; found are"),
    ({"time_s": "frame"}, (), "counts samples: how many a second? --rate HZ"),
    ({"time_s": "u"}, (), "no column for time, and no --rate HZ"),
    ({"shank_l_deg": "thigh_left", "thigh_l_deg": "LThigh"}, (), "2 columns could be thigh_l: LThigh, thigh_left"),
    ({}, ("--reverse", "kneee_l"), "--reverse kneee_l: there is no such angle; these are"),
])
def test_what_is_missing_is_said_with_what_is_there(made, tmp_path, names, options, words):
    path = walk_files.table(tmp_path / "walk.csv", made, names=names)
    done = run(path, *options, command="import")
    assert done.returncode == 2 and words in done.stderr and done.stdout == ""


@pytest.mark.parametrize("name,content,words", [
    ("empty.csv", b"", "the file is empty"),
    ("text.csv", b"a walk\nin words\n", "this is no table in a text file"),
    ("bare.csv", b"0,1,2\n1,2,3\n2,3,4\n", "no line of 3 names is above it"),
    ("zero.csv", b"a,b\n1,2\n\0", "a zero byte"),
    ("walk.mot", b"time x\n0 1\n", "no line \"endheader\""),
    ("walk.trc", b"markers\n", "no line begins with Frame#"),
    ("walk.c3d", b"no c3d", "ezc3d cannot read it"),
    ("bus.asc", b"nothing\n", "there is no frame in it"),
    ("bus.log", b"(1.0) can0 080#\n", "afo replay and afo view --replay read it as it is"),
])
def test_what_is_no_walk_is_refused_in_words(tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    done = run(tmp_path / name, command="import")
    assert done.returncode == 2 and words in done.stderr, done.stderr
    assert "Traceback" not in done.stderr


def test_a_number_that_is_none_is_named_by_line(made, tmp_path):
    path = walk_files.table(tmp_path / "walk.csv", made)
    lines = path.read_text().splitlines()
    lines[7] = lines[7].replace(lines[7].split(",")[1], "1.2.3", 1)
    path.write_text("\n".join(lines) + "\n")
    done = run(path, command="import")
    assert done.returncode == 2 and "line 8, column \"thigh_l_deg\": \"1.2.3\" is not a number" in done.stderr


def test_a_missing_package_is_named_with_its_command(made, tmp_path):
    path = walk_files.c3d(tmp_path / "walk.c3d", made)
    done = subprocess.run([AFO, "import", path], capture_output=True, text=True, check=False,
                          env={"PATH": "/usr/bin", "AFO_PYTHON": "/usr/bin/python3"}, timeout=60)
    assert done.returncode == 2
    assert "the Python package ezc3d is missing" in done.stderr and "-m pip install ezc3d" in done.stderr


def test_without_numpy_that_is_said(made, tmp_path):
    """A Python that has nothing but its own library."""
    bare = tmp_path / "python"
    bare.write_text(f"#!/bin/sh\nexec {sys.executable} -I -S \"$@\"\n")
    bare.chmod(0o755)
    done = subprocess.run([AFO, "import", walk_files.table(tmp_path / "walk.csv", made)], capture_output=True, text=True,
                          check=False, env={"PATH": "/usr/bin", "AFO_PYTHON": str(bare)}, timeout=60)
    assert done.returncode == 2 and "sudo apt-get install python3-numpy" in done.stderr and "Traceback" not in done.stderr


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("log") / "walk.log"
    assert run("--steps", "4", "--log", path).returncode == 0
    return path


@pytest.mark.parametrize("suffix", ["asc", "trc", "blf"])
def test_a_log_of_another_tool_replays(log, suffix, tmp_path):
    """Written by python-can; a second bus is recorded beside the device's."""
    with can.LogReader(str(log)) as reader:
        messages = list(reader)
    for message in messages:
        message.channel = 2 if suffix != "trc" else 1
    with can.Logger(str(tmp_path / f"walk.{suffix}")) as writer:
        for i, message in enumerate(messages):
            writer.on_message_received(message)
            if i % 50 == 0 and suffix != "trc":
                writer.on_message_received(can.Message(timestamp=message.timestamp, arbitration_id=0x80, channel=0,
                                                       is_extended_id=False))
    options = ("--interface", "can2") if suffix != "trc" else ()
    done = run(tmp_path / f"walk.{suffix}", "--out", tmp_path / "back.log", *options, command="import")
    assert done.returncode == 0, done.stderr

    def frames(path):
        return [line.split()[2] for line in path.read_text().splitlines()]
    assert frames(tmp_path / "back.log") == frames(log)
    assert run(tmp_path / "back.log", command="replay").returncode == 0
    if suffix != "trc":
        done = run(tmp_path / f"walk.{suffix}", "--interface", "can7", command="import")
        assert done.returncode == 2 and "it has no interface can7, but can" in done.stderr
