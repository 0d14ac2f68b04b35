"""The nodes and the controller as other people's software sees them: the Python packages
canopen and cantools, can-utils. They share no code with this project."""
import csv
import json
import subprocess

import pytest

from afo import BUILD, ROOT, run

cantools = pytest.importorskip("cantools")
pytest.importorskip("canopen")
PYTHON = ROOT / "build" / "venv" / "bin" / "python"


def in_guest(script, seconds):
    """Runs shell lines where vcan0 is; gives back what they printed."""
    done = subprocess.run(["scripts/vcan-guest", "--timeout", str(seconds), "--", "bash", "-c", script],
                          cwd=ROOT, capture_output=True, text=True, timeout=seconds + 30)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_canopen_is_master_of_the_virtual_nodes():
    out = in_guest(f"""
        {BUILD}/afo walker --can vcan0 --silence 60000 --quiet & walker=$!
        sleep 0.5
        {PYTHON} tests/system/peer_drive.py; status=$?
        kill -TERM $walker; wait $walker
        exit $status""", 150)
    assert out.rstrip().endswith("done"), out
    assert out.count("\n") == 10, out


def test_canopen_and_can_utils_during_a_walk(tmp_path):
    """What they said, and how the controller took it, is all in the log: it replays to its end, another
    node's targets and an SDO client's questions about counters included."""
    log = tmp_path / "walk.log"
    out = in_guest(f"""
        candump -L -r 268435456 vcan0 >{log} & dump=$!
        {BUILD}/afo walker --can vcan0 --silence 60000 --quiet & walker=$!
        sleep 0.3
        {BUILD}/afo host --can vcan0 --speed 0.41 --quiet & host=$!
        {PYTHON} tests/system/peer_tool.py; status=$?
        kill -TERM $host; wait $host; [ $? = 1 ] || status=1 # it tells the fault
        kill -TERM $walker; wait $walker; [ $? -le 1 ] || status=1 # they may have fallen
        cansend vcan0 1FFFFFFF#
        for _ in {{1..600}}; do tail -n 2 {log} | grep -q '1FFFFFFF#' && break; sleep 0.1; done
        kill -TERM $dump
        exit $status""", 400)
    assert out.rstrip().endswith("done"), out
    assert out.count("\n") == 6, out
    done = run("--speed", "0.41", log, command="replay")
    assert done.returncode == 1 and "1 such frame" in done.stdout, done.stdout  # 0x000: who sent it?
    done = run("--speed", "0.41", "--foreign-nodes", log, command="replay")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "3 frames of another node" in done.stdout, done.stdout  # 0x000, 0x601, 0x201


def told_steps(log):
    """The TELEMETRY of a log by step number, and how many frames were decoded."""
    db = cantools.database.load_file(str(ROOT / "hal" / "canopen" / "eds" / "afo.dbc"))
    steps, decoded = [], 0
    for line in log.read_text().splitlines():
        _, _, frame = line.split(" ")
        identifier, data = frame.split("#")
        if len(identifier) == 8:
            continue  # who recorded it: no frame of this bus
        message = db.get_message_by_frame_id(int(identifier, 16))
        raw = bytes.fromhex(data)
        assert len(raw) == message.length, message.name
        values = message.decode(raw) if message.signals else {}
        decoded += 1
        if message.name == "TELEMETRY" and values["StepNumber"] > 0:
            steps.append(values)
    return {values["StepNumber"]: values for values in steps}, decoded


def test_cantools_decodes_a_whole_walk_to_the_programs_own_numbers(tmp_path):
    log, table = tmp_path / "walk.log", tmp_path / "walk.csv"
    done = run("--steps", 30, "--speed", 0.45, "--log", log, "--csv", table, "--quiet")
    assert done.returncode == 0, done.stderr
    by_number, decoded = told_steps(log)
    assert decoded > 100000
    rows = [row for row in csv.DictReader(table.open()) if row["measured_speed_rad_s"]]
    assert len(rows) >= 25
    for row in rows:
        values = by_number[int(row["step"]) % 256]
        for signal, column, resolution in (("MeasuredSpeed", "measured_speed_rad_s", 1e-4),
                                           ("CommandedSpeed", "target_speed_rad_s", 1e-4),
                                           ("Precompression", "r0_m", 1e-5)):
            assert values[signal] == pytest.approx(float(row[column]), abs=0.51 * resolution)
        assert bool(values["RightSide"]) == (row["side"] == "right")
        assert values["FellBack"] == 0 and row["used_fallback"] == "0"


def test_a_step_left_to_equation_16_is_told_everywhere_alike(tmp_path):
    """On ground too rough for it the predictive law at last finds no push-off that survives."""
    log, table = tmp_path / "walk.log", tmp_path / "walk.csv"
    rough = ("--law", "predictive", "--start-r0", 0.23, "--speed", 1, "--terrain-mm", 20, "--seed", 1, "--steps", 60)
    done = run(*rough, "--log", log, "--csv", table, "--json")
    assert done.returncode == 1, done.stderr
    by_number, _ = told_steps(log)
    rows = [row for row in csv.DictReader(table.open()) if row["measured_speed_rad_s"]]
    on_bus = {number for number, values in by_number.items() if values["FellBack"]}
    assert 1 <= len(on_bus) < len(rows)
    assert on_bus == {int(row["step"]) for row in rows if row["used_fallback"] == "1"}
    assert on_bus == {i + 1 for i, used_fallback in enumerate(json.loads(done.stdout)["used_fallback"]) if used_fallback}
    text = run(*rough).stdout
    assert f"in {len(on_bus)} of {len(by_number)} steps, last in {max(on_bus)}" in text


def test_canplayer_plays_a_log_of_ours_and_candump_writes_the_same(tmp_path):
    log, part, back = tmp_path / "walk.log", tmp_path / "part.log", tmp_path / "back.log"
    done = run("--steps", 2, "--log", log, "--quiet")
    assert done.returncode == 0, done.stderr
    lines = log.read_text().splitlines()[:2000]
    part.write_text("".join(line + "\n" for line in lines))
    in_guest(f"""
        candump -L -r 16777216 -n {len(lines)} -T 5000 vcan0 >{back} & dump=$!
        sleep 0.5
        canplayer -t -I {part} vcan0=can0
        wait $dump""", 60)
    frames = [line.split(" ")[2] for line in lines]
    assert [line.split(" ")[2] for line in back.read_text().splitlines()] == frames
