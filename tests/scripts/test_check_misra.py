"""check-misra leaves nothing beside the sources, also when it is interrupted."""
import pathlib
import signal
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOMS = ("model", "controller", "hal", "firmware")


def heed_interrupts():
    """Tests that were themselves started in the background ignore them, and so would what they start."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def work_files():
    return [path for room in ROOMS for pattern in ("*.dump", "*.ctu-info") for path in (ROOT / room).rglob(pattern)]


def test_an_interrupted_run_leaves_no_work_files():
    for path in work_files():
        path.unlink()
    with subprocess.Popen([ROOT / "scripts" / "check-misra"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                          start_new_session=True, preexec_fn=heed_interrupts) as run:
        for _ in range(80):  # long enough for the first files to be judged
            time.sleep(0.1)
            assert not work_files()
        run.send_signal(signal.SIGINT)
        run.wait(timeout=60)
    assert run.returncode != 0
    assert not work_files()
