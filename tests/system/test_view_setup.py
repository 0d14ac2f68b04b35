"""The steps of commissioning from the page of afo view, with the virtual device in a stand."""
import contextlib
import csv
import io
import json
import os
import signal

import numpy as np
import pytest

from afo import ROOT, run
from chromium import Keys, Page, browser  # noqa: F401
from viewer import Talk, View, viewing

DEVICE = ROOT / "sim_host" / "devices" / "virtual.ini"
STAND = ("--speed", "0.41", "--stand", "--device", DEVICE)


class Setup(Talk):
    """Somebody at the page."""

    def run_step(self, step, **more):
        """Asks for a step and answers yes to what it asks. Returns the state when it is over."""
        self.begin(step, **more)
        while True:
            told = self.until(lambda m: m.get("type") == "commissioning", f"{step} goes on")
            if not told["running"]:
                return told
            if told["question"]:
                self.ask(do="commission", deed="answer", yes=True)

    def begin(self, step, deed="run", **more):
        self.ask(do="commission", deed=deed, step=step, **{"in_stand": True, **more})
        return self.until(lambda m: m.get("type") == "commissioning" and m["running"] == step, f"{step} begins")

    def refusal(self, do, **what):
        self.ask(do=do, **what)
        return self.until(lambda m: m.get("type") == "refused" and m.get("do") == do, "a refusal")["text"]


def verdicts(told):
    return {step["name"]: step["verdict"] for step in told["steps"]}


def motors(log):
    """What both motors read, m, tick by tick, as the drives' own frames in the log tell it."""
    done = run("--log", log, "--speed", "0.41", "--device", DEVICE, "--export", "csv", "--out", "-", command="report")
    assert done.returncode == 0, done.stderr
    table = list(csv.DictReader(io.StringIO(done.stdout)))
    return [np.array([float(row[f"motor_{side}"] or "nan") for row in table]) for side in ("left", "right")]


def test_steps_are_run_in_their_order_answered_and_written_down(tmp_path):
    """The motors move as far as the step says and no further, in the drives' own frames; the trial replays."""
    with viewing(*STAND, "--control", "--trials", tmp_path, "--log", tmp_path / "w.log") as view:
        page = Setup(view)
        assert page.refusal("commission", deed="run", step="identify").startswith("Say first that the device is in a stand")
        assert page.refusal("commission", deed="run", step="everything", in_stand=True) == "Commissioning has no such step."
        assert "Write a reason" in page.refusal("commission", deed="skip", step="rest", reason=" ")
        page.ask(do="record", on=True, subject="S1")
        early = page.run_step("moves")
        assert verdicts(early)["moves"] == "interrupted" and any("comes first" in line for line in early["lines"])
        assert verdicts(page.run_step("identify"))["identify"] == "passed"
        skipped = page.run_step("rest", deed="skip", reason="seen by hand; twice")
        assert verdicts(skipped)["rest"] == "skipped"
        page.begin("moves")
        assert "moves" in page.refusal("write", name="commands.desired_apex_speed", value=0.42)
        assert "under way" in page.refusal("commission", deed="run", step="identify", in_stand=True)
        while (told := page.until(lambda m: m.get("type") == "commissioning", "moves"))["running"]:
            if told["question"]:
                assert "motor that moved" in told["question"]
                page.ask(do="commission", deed="answer", yes=True)
        assert verdicts(told)["moves"] == "passed" and told["has_page"]
        page.ask(do="record", on=False)
        page.until(lambda m: m.get("type") == "trials" and m["trials"] and m["trials"][0]["complete"], "kept")
    folder = tmp_path / "commissioning-virtual"
    assert "seen by hand" in (folder / "commissioning.html").read_text(encoding="utf-8")
    assert run("check", folder / "commissioned.ini", command="device").returncode == 0
    trial = next(tmp_path.glob("*S1"))
    done = run("--speed", "0.41", "--device", DEVICE, trial / "bus.log", command="replay")
    assert done.returncode == 0 and "reproduced" in done.stdout, done.stdout + done.stderr
    writes = [one["name"] for one in map(json.loads, open(trial / "events.jsonl", encoding="utf-8")) if one["kind"] == "write"]
    assert len(writes) > 4  # on the bus, as any tool's
    for motor in motors(tmp_path / "w.log"):
        assert 0.010 < np.nanmax(motor) < 0.015 and abs(motor[-1]) < 0.001


@pytest.mark.parametrize("end", ["the browser leaves", "interrupt", "stop", "the server is killed"])
def test_a_step_that_is_broken_off_ends_unloaded(tmp_path, end):
    view = View(*STAND, "--control", "--trials", tmp_path, "--log", tmp_path / "w.log")
    try:
        page = Setup(view)
        for step in ("identify", "rest"):
            page.run_step(step, deed="skip", reason="not now")
        page.begin("moves")
        page.until(lambda m: m.get("kind") == "state" and m["state"] == "commissioning", "the motor may move")
        if end == "the server is killed":
            os.kill(view.server_pid(), signal.SIGKILL)
            with contextlib.suppress(Exception):
                while page.socket.recv():
                    pass
            unloaded_by_itself(view)
        else:
            other = Setup(view)
            if end == "the browser leaves":
                page.close()
            elif end == "interrupt":
                other.ask(do="commission", deed="interrupt")
            else:
                other.ask(do="request", what="stop")
            told = other.until(lambda m: m.get("type") == "commissioning" and not m["running"], "it ends")
            assert verdicts(told)["moves"] == "interrupted"
            hello = Setup(view).hear()
            assert hello["state"] != "FAULT"
    finally:
        view.end()
    for motor in motors(tmp_path / "w.log"):
        assert np.nanmax(motor) < 0.015 and abs(motor[-1]) < 0.001


def unloaded_by_itself(view):
    """The walk goes on without its server; so many bytes of log are more than the time the controller has to unload in."""
    log = next(one for one in map(str, view.process.args) if one.endswith("w.log"))
    folder, name = os.path.split(log)
    part = [one for one in os.listdir(folder) if name in one][0]
    size = os.path.getsize(os.path.join(folder, part))
    from viewer import wait_until
    wait_until(lambda: os.path.getsize(os.path.join(folder, part)) > size + 3000000, "some seconds of log")


def test_nothing_moves_without_control_or_a_device_file(tmp_path):
    with viewing(*STAND, "--trials", tmp_path) as view:
        page = Setup(view)
        assert "commissioning" not in page.hear()
        page.ask(do="commission", deed="run", step="identify", in_stand=True)
        page.until(lambda m: m.get("type") == "refused", "a refusal")
    with viewing("--speed", "0.41", "--stand", "--control", "--trials", tmp_path) as view:
        assert "--device FILE" in Setup(view).refusal("commission", deed="run", step="identify", in_stand=True)


def test_the_page_shows_the_steps(browser, tmp_path):  # noqa: F811
    """By keyboard: nothing can be run before the device is said to be in a stand."""
    with viewing(*STAND, "--control", "--trials", tmp_path) as view:
        page = Page(browser, view)
        page.until("return document.querySelectorAll('#setup-steps li').length === 11", "the steps")
        assert page.js("return document.getElementById('setup-run-identify').disabled")
        page.tab_to("setup-stand", "setup")
        page.keys(" ")
        page.focus("setup-run-identify").send_keys(Keys.ENTER)
        page.until("return document.querySelector('#setup-steps li .verdict').innerText === 'passed'", "identify passed")
        page.focus("setup-reason").send_keys("seen by hand")
        page.focus("setup-skip-rest").send_keys(Keys.ENTER)
        page.until("return document.querySelectorAll('#setup-steps li .verdict')[1].innerText === 'skipped'", "rest skipped")
        assert page.js("return document.getElementById('setup-run-spring').disabled && !document.getElementById('setup-run-moves').disabled")
        page.focus("setup-run-moves").send_keys(Keys.ENTER)
        page.until("return !document.getElementById('setup-answers').hidden", "a question")
        page.js("document.getElementById('setup').scrollIntoView()")
        page.picture("setup")
        page.focus("setup-yes").send_keys(Keys.ENTER)
        page.until("return document.getElementById('setup-answers').hidden", "answered")
        page.focus("setup-interrupt").send_keys(Keys.ENTER)
        page.until("return document.getElementById('setup-now').hidden", "interrupted")
        page.focus("setup-page").send_keys(Keys.ENTER)
        page.until("return document.querySelector('dialog .report')?.innerText.includes('seen by hand')", "the page to sign")
        page.keys(Keys.ESCAPE)
        assert page.complaints() == []
