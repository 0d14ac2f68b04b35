"""Either side of the real bus is killed and started again: the walk goes on, safely."""
import subprocess

import pytest

from afo import BUILD, ROOT


def campaign(times, limit_s):
    return subprocess.run(["scripts/vcan-guest", "--timeout", str(limit_s), "--",
                           "scripts/restart-campaign", "--times", str(times), "--build",
                           str(BUILD), "--limit", "90"],
                          cwd=ROOT, capture_output=True, text=True, timeout=limit_s + 60)


@pytest.mark.long
def test_each_side_killed_once():
    done = campaign(1, 480)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "2 kills" in done.stdout and " 0 unsafe commands" in done.stdout


@pytest.mark.long
def test_each_side_killed_ten_times():
    done = campaign(10, 3000)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "20 kills" in done.stdout and " 0 unsafe commands" in done.stdout


def test_an_unsafe_record_would_be_noticed(tmp_path):
    import importlib.machinery
    import importlib.util
    loader = importlib.machinery.SourceFileLoader("campaign",
                                                  str(ROOT / "scripts" / "restart-campaign"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("campaign", loader))
    loader.exec_module(module)

    def wrong(*frames):
        path = tmp_path / "record.log"
        path.write_text("".join(f"(1.0) vcan0 {frame}\n" for frame in frames))
        return module.Judge(path).read().wrong

    enabled, disabled = "181#2702E8030000", "181#5002E8030000"  # both at 1000 counts
    assert not wrong(disabled, "201#E803000000000000")
    assert wrong(disabled, "201#00000F0000000000")              # a kick to come
    assert not wrong(enabled, "201#E803000000000000", enabled, "201#E903000000000000")
    assert wrong(enabled, "201#E803000000000000", enabled, "201#00000F0000000000")  # a step
    assert wrong(disabled, "301#060000000100")                  # armed without torque
    assert not wrong(enabled, "301#0F0000000100")
