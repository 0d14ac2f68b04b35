"""The interface goes down and up again in the middle of a walk over vcan. Judged by the record that candump, of
can-utils, keeps of the bus, and by what the programs say. (What was lost on the way to an interface that is down
is in no record, so this one need not replay.)"""
import importlib.machinery
import importlib.util
import json
import subprocess

import pytest

from afo import BUILD, ROOT

GUEST = """
cd {out}
walk() {{ # walk NAME SECONDS HOST-OPTIONS...: down for so long, when it has told two steps
    name=$1; seconds=$2; shift 2
    candump -L -D -r 67108864 vcan0 >$name.log 2>/dev/null & dump=$!
    {build}/afo walker --can vcan0 --sensors ideal --json >$name.walker & walker=$!
    sleep 0.3
    {build}/afo host --can vcan0 --speed 0.45 "$@" >$name.out 2>$name.err & host=$!
    candump -n 3 vcan0,390:7FF >/dev/null
    ip link set vcan0 down; sleep $seconds; ip link set vcan0 up
    wait $host; echo $name $?
    kill -TERM $walker; wait $walker
    cansend vcan0 1FFFFFFF#
    for i in {{1..300}}; do tail -n 2 $name.log | grep -q 1FFFFFFF && break; sleep 0.1; done
    kill -TERM $dump; wait $dump
}}
walk short 0.05 --steps 5
walk long 4 --steps 50
"""


def judge(log):
    loader = importlib.machinery.SourceFileLoader("campaign", str(ROOT / "scripts" / "restart-campaign"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("campaign", loader))
    loader.exec_module(module)
    return module.Judge(log).read()


def test_a_walk_goes_on_or_ends_with_a_reason(tmp_path):
    script = tmp_path / "guest.sh"
    script.write_text(GUEST.format(build=BUILD, out=tmp_path))
    done = subprocess.run(["scripts/vcan-guest", "--timeout", "150", "--", "bash", str(script)], cwd=ROOT,
                          capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stdout + done.stderr
    # Shorter than anybody's time-out it is nothing but some lost frames; longer, the drives unload by themselves.
    assert done.stdout.split() == ["short", "0", "long", "1"], done.stdout + done.stderr
    down = "afo host: vcan0 is down, nothing is sent or heard\nafo host: vcan0 is up again\n"
    assert (tmp_path / "short.err").read_text() == down
    told = (tmp_path / "long.err").read_text()
    # What the host sees first when the bus is back: the drives' own reaction, or one more tick without a telegram.
    reasons = tuple(f"afo host: stopped by a fault: {fault}\n" for fault in ("drive fault", "leg sensor silent", "drive silent"))
    assert told.startswith(down) and told.endswith(reasons), told
    for name, steps in (("short", 5), ("long", 2)):
        report = (tmp_path / f"{name}.out").read_text()
        assert "interface down 1 times" in report and "\n  steps      " in report, report
        assert json.loads((tmp_path / f"{name}.walker").read_text())["went_down"] == 1
        record = judge(tmp_path / f"{name}.log")
        assert not record.wrong and record.steps >= steps, (record.wrong, record.steps)


BUS_OFF = """
cd {out}
{build}/afo walker --can vcan0 --sensors ideal --json >off.walker & walker=$!
sleep 0.3
{build}/afo host --can vcan0 --speed 0.45 --steps 8 --auto-reset >off.out 2>off.err & host=$!
candump -n 2 vcan0,390:7FF >/dev/null
cansend vcan0 20000040#0000000000000000; sleep 0.03; cansend vcan0 {sign}
wait $host; echo host $?
kill -TERM $walker; wait $walker # 1: it fell before the drives were back
exit 0
"""


@pytest.mark.parametrize("sign", ["20000008#0000400000000000", "20000004#0040000000000000", "20000100#0000000000000000"])
def test_a_walk_survives_a_bus_off_that_is_over(tmp_path, sign):
    """The driver's error frames say that the controller chip is off the bus, and then, each driver in its way, that
    it takes part again (linux/can/error.h). The drives' controllers hear the same: each faults and unloads by itself
    (0x6007), and once that is reset the walk goes on."""
    script = tmp_path / "guest.sh"
    script.write_text(BUS_OFF.format(build=BUILD, out=tmp_path, sign=sign))
    done = subprocess.run(["scripts/vcan-guest", "--timeout", "60", "--", "bash", str(script)], cwd=ROOT,
                          capture_output=True, text=True, timeout=90)
    assert done.returncode == 0, done.stdout + done.stderr
    told = (tmp_path / "off.err").read_text()
    assert "afo host: vcan0 is bus-off" in told and "afo host: vcan0 is on the bus again" in told, told
    assert done.stdout.split() == ["host", "0"], done.stdout + told
    assert json.loads((tmp_path / "off.walker").read_text())["bus_off"] == 1
