"""afo view on a CAN bus, beside walker, host and another tool."""
import subprocess

import pytest

from afo import BUILD
from test_peers import PYTHON, in_guest


@pytest.mark.long
def test_it_shows_and_changes_a_device_on_a_bus(tmp_path):
    out = in_guest(f"""
        ip link set lo up
        {PYTHON} tests/system/peer_view.py {BUILD}/afo {tmp_path}""", 400)
    assert out.rstrip().endswith("done"), out
    assert out.count("\n") == 8, out


def test_an_interface_that_is_not_there_is_said():
    done = subprocess.run([BUILD / "afo", "view", "--can", "nocan9", "--port", "0"], capture_output=True, text=True, timeout=120)
    assert done.returncode == 2 and done.stderr and "Traceback" not in done.stderr
