"""scripts/tick-trace: what a trace port's bytes say, by the packets of the Armv7-M manual, appendix D4."""
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
ENGINE = list((ROOT / "build" / "venv").glob("lib/python3*/site-packages/unicorn/lib/libunicorn.so.2"))


def word(port, value):
    return bytes([port << 3 | 3]) + value.to_bytes(4, "little")


def tick(number, cycles, state, fault=0):
    return word(0, number) + word(1, cycles) + word(2, state | fault << 8)


def read(tmp_path, data):
    path = tmp_path / "trace.bin"
    path.write_bytes(data)
    result = subprocess.run([str(ROOT / "scripts/tick-trace"), str(path)], capture_output=True, text=True)
    return result.returncode, result.stdout.split(), result.stderr


def test_whole_ticks_are_told_between_other_packets(tmp_path):
    synchronisation, overflow, time_stamp = bytes(5) + b"\x80", b"\x70", b"\xc0\x81\x01"
    data = synchronisation + tick(7, 13012, 4) + overflow + time_stamp + tick(8, 9876, 6, 23)
    assert read(tmp_path, data) == (0, ["7,13012,4,0", "8,9876,6,23"], "")


def test_a_tick_with_a_hole_is_left_out_and_counted(tmp_path):
    data = word(1, 1) + tick(1, 2, 3) + word(0, 2) + word(2, 3) + tick(3, 4, 5) + word(0, 4)[:3]
    status, rows, complaint = read(tmp_path, data)
    assert status == 0 and rows == ["1,2,3,0", "3,4,5,0"] and complaint.startswith("3 words")


def test_nothing_is_a_failure(tmp_path):
    assert read(tmp_path, b"")[0] == 1


@pytest.mark.long
@pytest.mark.skipif(not ENGINE, reason="the Unicorn engine is not in build/venv (scripts/setup test)")
def test_an_image_built_with_a_trace_tells_each_tick_and_the_usual_one_none(tmp_path):
    subprocess.run(["make", "-s", "BUILD=build/trace", "TRACE=swo", "build/trace/arm/afo-nucleo-g474re.bin"], cwd=ROOT,
                   check=True, capture_output=True)
    trace, costs = tmp_path / "trace.bin", tmp_path / "costs.csv"
    walk = [str(ROOT / "build/afo"), "g474", "--quiet", "--steps", "3", "--speed", "0.45", "--trace", str(trace), "--costs", str(costs)]
    assert subprocess.run(walk, cwd=ROOT).returncode == 0
    assert trace.read_bytes() == b""
    assert subprocess.run([*walk, "--image", "build/trace/arm/afo-nucleo-g474re.bin"], cwd=ROOT).returncode == 0
    _, rows, complaint = read(tmp_path, trace.read_bytes())
    numbers = [[int(field) for field in row.split(",")] for row in rows]
    ticks = [row[0] for row in numbers[1:]]
    assert complaint == "" and len(ticks) > 3000 and ticks == list(range(ticks[0], ticks[0] + len(ticks)))
    assert {row[2] for row in numbers} >= {4} and max(row[1] for row in numbers) > max(
        int(line.split(",")[1]) for line in costs.read_text().splitlines())
