"""A node that others made, beside the controller and the other three: the left leg's sensor is the Python
package canopen's LocalNode. It shares no code with this project."""
import json

import pytest

from afo import BUILD, ROOT
from test_peers import in_guest

pytest.importorskip("canopen")
PYTHON = ROOT / "build" / "venv" / "bin" / "python"


def walk(tmp_path, *options):
    """Three steps with it; gives back what it and the host say, the latter's exit status first."""
    out = in_guest(f"""
        ip link add dev vcan1 type vcan && ip link set dev vcan1 up || exit 125
        {BUILD}/afo walker --can vcan1 --silence 60000 --quiet & walker=$!
        {PYTHON} tests/system/peer_sensor.py {' '.join(options)} >{tmp_path}/sensor & sensor=$!
        sleep 2
        {BUILD}/afo host --can vcan0 --steps 3 --speed 0.41 --answer-timeout 60000 --json \
            >{tmp_path}/host 2>{tmp_path}/complaint
        echo $?
        kill -TERM $sensor; wait $sensor || exit 1
        kill -TERM $walker; wait $walker
        ip link del dev vcan1
        true""", 240)
    said = dict(line.split(": ") if ": " in line else (line.rstrip(":"), "")
                for line in (tmp_path / "sensor").read_text().splitlines())
    return int(out.split()[0]), said, tmp_path


def test_a_walk_with_another_stacks_node_as_leg_sensor(tmp_path):
    status, said, files = walk(tmp_path)
    assert status == 0, (files / "complaint").read_text()
    host = json.loads((files / "host").read_text())
    assert host["steps"] == 3 and host["fault"] == 0 and host["lost_cycles"] == 0, host
    assert said["heartbeat"] == "100 ms" and said["state"] == "OPERATIONAL", said
    for mapped in ("0x1016:1", "0x1017:0", "0x1801:1", "0x1801:2", "0x1A01:0", "0x1A01:1", "0x1A01:2"):
        assert mapped in said["written"].split(), said
    assert int(said["PDOs"]) > 1500, said


def test_another_stacks_node_with_another_resolution_is_refused_by_name(tmp_path):
    status, said, files = walk(tmp_path, "--steps-per-turn", "4096")
    complaint = (files / "complaint").read_text()
    assert status == 1 and "6001" in complaint and ("0x1000\n" in complaint or "4096" in complaint), complaint
    assert said["state"] != "OPERATIONAL" and said["PDOs"] == "0", said
