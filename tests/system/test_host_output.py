"""afo host and afo walker on a real CAN stack: a report that cannot be written is no success."""
import re
import subprocess

import pytest

from afo import BUILD, ROOT


@pytest.mark.parametrize("program", ["host", "walker"])
def test_a_report_that_is_lost_is_told(program):
    # Alone on the bus: it waits for the others until it is told to end, and reports.
    script = f'"{BUILD}/afo" {program} --can vcan0 >/dev/full & p=$!; sleep 2; kill -INT $p; wait $p'
    done = subprocess.run(["scripts/vcan-guest", "--", "sh", "-c", script], cwd=ROOT, capture_output=True, text=True,
                          timeout=200)
    assert done.returncode == 2, done.stdout + done.stderr
    assert f"afo {program}: cannot write to standard output: No space left on device" in done.stderr


@pytest.mark.parametrize("program", ["host", "walker"])
def test_an_interface_name_that_is_too_long_is_called_that(program):
    done = subprocess.run([BUILD / "afo", program, "--can", "a-name-of-too-many-letters"], capture_output=True, text=True)
    assert done.returncode == 2
    assert "a-name-of-too-many-letters: File name too long" in done.stderr


BEGIN = f"""
begin() {{ # begin NAME HOST-OPTIONS...: a walk with its record; the host's lines in NAME.out
    name=$1; shift
    candump -L -r 67108864 vcan0,181:7FF,182:7FF,7FF:7FF >$name.log & dump=$!
    "{BUILD}/afo" walker --can vcan0 --silence 60000 --quiet & walker=$!
    sleep 0.3
    "{BUILD}/afo" host --can vcan0 --speed 0.45 --answer-timeout 3000 "$@" >$name.out 2>$name.err & host=$!
}}
until_walking() {{ until grep -q walking $name.out; do sleep 0.05; done; }}
ended() {{
    wait $host; echo $name $?
    cansend vcan0 7FF# # candump may lie behind: it is done when it has written this
    for i in {{1..100}}; do tail -n 2 $name.log | grep -q 7FF && break; sleep 0.1; cansend vcan0 7FF#; done
    kill -TERM $walker $dump; wait $walker $dump 2>/dev/null
}}
"""


def in_guest(tmp_path, script):
    script = f"cd {tmp_path}; {BEGIN} {script}"
    done = subprocess.run([ROOT / "scripts" / "vcan-guest", "--timeout", "150", "--", "bash", "-c", script], cwd=ROOT,
                          capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stdout + done.stderr
    return dict(line.split(" ") for line in done.stdout.splitlines())


def drives_left_off(log):
    """Whether both drives were enabled once, and neither was when they last spoke (CiA 402 statuswords)."""
    enabled = {}
    for line in log.read_text().splitlines():
        identifier, data = line.split(" ")[2].split("#")
        if identifier == "7FF":
            continue
        is_enabled = int.from_bytes(bytes.fromhex(data)[:2], "little") & 0x6F == 0x27
        was, _ = enabled.get(identifier, (False, False))
        enabled[identifier] = (was or is_enabled, is_enabled)
    return enabled == {"181": (True, False), "182": (True, False)}


def test_a_hangup_or_a_reader_that_went_away_unloads_and_ends(tmp_path):
    # The reader leaves at the line before "walking", so that this line is the one that is lost.
    status = in_guest(tmp_path, """
        mkfifo pipe.out
        sed -u '/engaging/q' <pipe.out >/dev/null & begin pipe; ended
        begin hangup; until_walking; kill -HUP $host; ended""")
    assert status == {"pipe": "2", "hangup": "0"}
    assert (tmp_path / "pipe.err").read_text() == "afo host: cannot write to standard output: Broken pipe\n"
    assert (tmp_path / "hangup.err").read_text() == ""
    for name in status:
        assert drives_left_off(tmp_path / f"{name}.log"), name


def test_report_and_complaint_in_one_file_stay_in_their_order(tmp_path):
    script = f"""
        "{BUILD}/afo" walker --can vcan0 --silence 60000 --quiet & walker=$!
        "{BUILD}/afo" host --can vcan0 --speed 0.45 --answer-timeout 3000 >{tmp_path}/both 2>&1 & host=$!
        until grep -q engaging {tmp_path}/both; do sleep 0.05; done
        kill -KILL $walker; wait $walker
        until grep -q unloading: {tmp_path}/both; do sleep 0.05; done
        kill -TERM $host; wait $host; true"""
    done = subprocess.run(["scripts/vcan-guest", "--timeout", "150", "--", "bash", "-c", script], cwd=ROOT,
                          capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = (tmp_path / "both").read_text().splitlines()
    assert all(re.match(r"  (tick|steps|ticks|bus|state) +\S|afo host: \S|$", line) for line in lines), lines
    assert lines[-2].startswith("  state ") and lines[-1].startswith("afo host: stopped by a fault: "), lines


def test_a_node_that_is_refused_ends_a_walk_of_so_many_steps(tmp_path):
    """The drives count half as finely as the host's device file says. With --auto-reset it waits until they were
    exchanged, and walks."""
    text = (ROOT / "sim_host" / "devices" / "virtual.ini").read_text()
    finer = re.sub(r"(?m)^counts_per_m *= *13107200", "counts_per_m = 26214400", text)
    assert finer != text
    (tmp_path / "finer.ini").write_text(finer)
    status = in_guest(tmp_path, f"""
        begin refused --device finer.ini --steps 1000; ended
        begin exchanged --device finer.ini --steps 2 --auto-reset
        until grep -q refused exchanged.err; do sleep 0.05; done
        sleep 1
        kill -KILL $walker; wait $walker 2>/dev/null
        "{BUILD}/afo" walker --can vcan0 --device finer.ini --silence 60000 --quiet & walker=$!
        ended""")
    assert status == {"refused": "1", "exchanged": "0"}
    for name in status:
        assert (tmp_path / f"{name}.err").read_text() == \
            "afo host: left drive, node 1, refused: object 0x6092:01 (scale): expected 26214400 counts/m, found 13107200 " \
            "counts/m; key of the device file: counts_per_m\n"


def test_a_walk_of_so_many_steps_ends_with_a_latched_fault(tmp_path):
    # A stranger who speaks as the controller; and a walker that is gone for good.
    status = in_guest(tmp_path, """
        begin stranger --steps 1000; until_walking; cansend vcan0 201#0000000000000000; ended
        begin gone --steps 1000; until_walking; kill -KILL $walker; ended""")
    assert status == {"stranger": "1", "gone": "1"}
    for name, fault in (("stranger", "foreign node on the bus"), ("gone", "silent")):
        told = (tmp_path / f"{name}.err").read_text()
        assert told.startswith("afo host: stopped by a fault: ") and fault in told, told
