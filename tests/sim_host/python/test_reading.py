"""Logs and trials as tables."""
import json
import os
import shutil
import subprocess

import numpy
import pandas
import pytest

from package_tree import BUILD


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """A log of four steps, and the table that the same walk wrote."""
    path = tmp_path_factory.mktemp("log") / "walk.log"
    subprocess.run([BUILD / "afo", "sim", "--speed", "0.45", "--steps", "4", "--sensors", "ideal", "--quiet", "--log", path],
                   check=True)
    return path


def test_a_log_is_a_table_by_tick(afo, log):
    frame = afo.read_log(log)
    walk = afo.sim(speed=0.45, steps=4, sensors="ideal", ticks=True)
    assert list(frame.columns[:2]) == ["tick", "time"] and frame.attrs["units"]["leg_angle_left"] == "rad"
    truth = walk.ticks.set_index("tick").theta_left_rad
    late = frame[(frame.tick > 3000) & (frame.tick < len(truth) - 5)]
    # Sampled at a SYNC, heard behind it: at most a tick apart from the truth, at rates below 5 rad/s.
    assert numpy.abs(late.leg_angle_left.to_numpy() - truth.loc[late.tick].to_numpy()).max() < 0.01
    speeds = [event["speed_rad_s"] for event in frame.attrs["events"] if event["kind"] == "step"]
    assert numpy.allclose(speeds, walk.steps.measured_speed_rad_s[:len(speeds)], atol=1e-3) and len(speeds) >= 3


def test_a_trial_is_the_table_of_its_log(afo, log, tmp_path):
    """A folder as afo view keeps it, with the subject that afo tells its own Python programs."""
    told = tmp_path / "python"
    told.write_text('#!/bin/sh\nwhile [ $# -gt 1 ]; do [ "$1" != --subject ] || printf %s "$2"; shift; done\n')
    told.chmod(0o755)
    subject = json.loads(subprocess.run([BUILD / "afo", "report", log, "--log", "--export", "csv", "--out", "-"], text=True,
                                        env={**os.environ, "AFO_PYTHON": str(told)}, capture_output=True, check=True).stdout)
    trial = tmp_path / "trial"
    trial.mkdir()
    shutil.copy(log, trial / "bus.log")
    (trial / "events.jsonl").write_text("")
    with pytest.raises(afo.AfoError, match="it has no trial.json"):
        afo.read_trial(trial)
    (trial / "trial.json").write_text(json.dumps({"subject": subject, "parameters": subject["parameters"], "subject_code": "P07"}))
    frame = afo.read_trial(trial)
    pandas.testing.assert_frame_equal(frame, afo.read_log(log))
    assert frame.attrs["provenance"]["subject_code"] == "P07" and frame.attrs["units"]["motor_left"] == "m"


@pytest.mark.parametrize("read,path,words", [
    ("read_log", "/nowhere/walk.log", "no such file"),
    ("read_log", "/tmp", "is a folder; a trial is read by read_trial"),
    ("read_trial", "/nowhere", "no folder of a trial; a log is read by read_log"),
    ("read_log", __file__, "no line of a candump log"),
])
def test_what_is_no_log_is_said(afo, read, path, words):
    with pytest.raises(afo.AfoError, match=words):
        getattr(afo, read)(path)
