"""scripts/with-progress: tells how far a command is, and hands on its output and exit status."""
import os
import pathlib
import signal
import subprocess
import time

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "with-progress"


def command(folder, total, *words):
    return [SCRIPT, "--name", "job", "--total", str(total), "--files", str(folder / "out*"), "--log", str(folder / "log"),
            "--every", "0.2", "--", *words]


def test_progress_goes_to_standard_error_and_the_log(tmp_path):
    (tmp_path / "out0").write_text("done before\n")
    done = subprocess.run(command(tmp_path, 5, "sh", "-c", f"for i in 1 2 3 4; do sleep 0.3; echo $i >>{tmp_path}/out1; done;"
                                  " echo result"), capture_output=True, text=True, timeout=30)
    assert (done.returncode, done.stdout) == (0, "result\n")
    lines = done.stderr.splitlines()
    assert lines[0].startswith("job: 5 to do, 1 done before")
    assert any("about" in line and "left" in line for line in lines)
    assert lines[-1].startswith("job: 5 of 5 after")
    assert (tmp_path / "log").read_text() == done.stderr


@pytest.mark.parametrize("words,status", [(["false"], 1), (["sh", "-c", "exit 7"], 7), (["sh", "-c", "kill -9 $$"], 137),
                                          (["./no-such-program"], 2)])
def test_the_exit_status_is_the_commands(words, status, tmp_path):
    done = subprocess.run(command(tmp_path, 1, *words), capture_output=True, text=True, timeout=30)
    assert done.returncode == status and "Traceback" not in done.stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_command_too(number, tmp_path):
    process = subprocess.Popen(command(tmp_path, 1, "sh", "-c", f"echo $$ >{tmp_path}/pid; exec sleep 60"),
                               stderr=subprocess.DEVNULL, start_new_session=True)
    try:
        limit = time.monotonic() + 10
        while not (tmp_path / "pid").exists() or not (tmp_path / "pid").read_text():
            assert time.monotonic() < limit
            time.sleep(0.02)
        time.sleep(0.2)
        if number == signal.SIGINT:
            os.killpg(process.pid, number)
        else:
            process.send_signal(number)
        assert process.wait(timeout=5) == 128 + number
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
