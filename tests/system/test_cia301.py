"""Every node of the project is asked from outside what CiA 301 asks of it, clause by clause."""
import collections

import pytest

from afo import BUILD, ROOT
from test_peers import in_guest

pytest.importorskip("can")
PYTHON = ROOT / "build" / "venv" / "bin" / "python"


def test_every_node_answers_as_cia_301_says():
    """The nodes first, with no master on the bus; then the controller, with no node."""
    out = in_guest(f"""
        status=0
        {BUILD}/afo walker --can vcan0 --silence 20 --quiet & walker=$!
        {PYTHON} tests/system/peer_cia301.py 1 drive 2 drive 3 sensor 4 sensor || status=1
        kill -TERM $walker; wait $walker
        {BUILD}/afo host --can vcan0 --speed 0.41 --quiet & host=$!
        {PYTHON} tests/system/peer_cia301.py 16 controller || status=1
        kill -TERM $host; wait $host
        exit $status""", 900)
    answers = [line.split(" | ") for line in out.splitlines() if line.startswith("ok")]
    assert out.count("done\n") == 2, out
    asked = collections.defaultdict(set)
    for _, node, clause, what in answers:
        assert clause.startswith("CiA 301, 7."), clause
        asked[node].add(clause + what)
    assert sorted(asked) == ["controller 16", "drive 1", "drive 2", "sensor 3", "sensor 4"], sorted(asked)
    for node, checks in asked.items():
        assert len(checks) >= 50, (node, len(checks))
    assert len(set().union(*asked.values())) >= 60
