"""afo-host and afo-walker on a real CAN stack: a report that cannot be written is no success."""
import subprocess

import pytest

from afo import BUILD, ROOT


@pytest.mark.parametrize("program", ["afo-host", "afo-walker"])
def test_a_report_that_is_lost_is_told(program):
    # Alone on the bus: it waits for the others until it is told to end, and reports.
    script = f'"{BUILD / program}" --can vcan0 >/dev/full & p=$!; sleep 2; kill -INT $p; wait $p'
    done = subprocess.run(["scripts/vcan-guest", "--", "sh", "-c", script], cwd=ROOT, capture_output=True, text=True,
                          timeout=200)
    assert done.returncode == 2, done.stdout + done.stderr
    assert f"{program}: cannot write to standard output: No space left on device" in done.stderr


@pytest.mark.parametrize("program", ["afo-host", "afo-walker"])
def test_an_interface_name_that_is_too_long_is_called_that(program):
    done = subprocess.run([BUILD / program, "--can", "a-name-of-too-many-letters"], capture_output=True, text=True)
    assert done.returncode == 2
    assert "a-name-of-too-many-letters: File name too long" in done.stderr
