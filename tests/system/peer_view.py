"""Runs where vcan0 is: afo view on a bus, as the only one who watches and as one who changes. Every line printed is a check
that held. Arguments: the program afo, a folder for files."""
import html
import pathlib
import re
import signal
import subprocess
import sys

from viewer import Talk, View

AFO, FOLDER = sys.argv[1], pathlib.Path(sys.argv[2])


def say(text):
    print(text, flush=True)


def ctl(*words):
    done = subprocess.run([AFO, "ctl", "--can", "vcan0", *words], capture_output=True, text=True, timeout=200, check=False)
    assert done.returncode == 0, (words, done.stdout, done.stderr)
    return done.stdout


def begin_host():
    return subprocess.Popen([AFO, "host", "--can", "vcan0", "--speed", "0.41", "--quiet"])


def kept(message, code):
    return any(one["name"].endswith(code) and one["complete"] for one in message["trials"])


def keep(talk, code):
    """Some steps of a walk that goes on."""
    talk.ask(do="request", what="walk")
    talk.event("step")
    talk.ask(do="record", on=True, subject=code)
    assert talk.until(lambda m: m.get("type") == "recorder" and m["recorder"], "recording")["recorder"]["note"] == ""
    talk.event("step")
    talk.event("step")
    talk.ask(do="record", on=False)
    talk.until(lambda m: m.get("type") == "trials" and kept(m, code), "kept")


def replays(folder):
    """By the command that its report gives."""
    report = subprocess.run([AFO, "report", folder, "--out", "-"], capture_output=True, text=True, timeout=200, check=False).stdout
    command = html.unescape(re.search("<code>(.*?)</code>", report)[1]).replace("afo replay", f"{AFO} replay")
    done = subprocess.run(["bash", "-o", "pipefail", "-c", command], capture_output=True, text=True, timeout=200, check=False)
    assert done.returncode == 0 and "reproduced" in done.stdout, (command, done.stdout, done.stderr)


def main():
    view = View("--can", "vcan0", "--speed", "0.41", "--control", "--trials", FOLDER)
    talk = Talk(view)
    talk.ask(do="record", on=True, subject="BUS")
    talk.until(lambda m: m.get("type") == "recorder" and m["recorder"], "recording")
    walker = subprocess.Popen([AFO, "walker", "--can", "vcan0", "--silence", "60000", "--quiet"])
    host = begin_host()
    try:
        talk.event("step")
        say("steps are seen on a bus")
        talk.ask(do="write", name="commands.desired_apex_speed", value=0.42)
        assert talk.until(lambda m: m.get("type") == "written", "read back")["read"] == 0.42
        assert "0.42" in ctl("get", "desired_apex_speed")
        say("what the page writes another tool reads")
        ctl("set", "desired_apex_speed=0.415")
        event = talk.event("write", name="commands.desired_apex_speed", value=0.415)
        assert event["done"]
        say("what another tool writes the page shows")
        talk.ask(do="record", on=False)
        talk.until(lambda m: m.get("type") == "trials" and kept(m, "BUS"), "kept")
        talk.ask(do="request", what="stop")
        assert "standby" in talk.until(lambda m: m.get("type") == "request", "stopped")["text"]
        say("stop is obeyed")
        keep(talk, "MID")
        late = View("--can", "vcan0", "--speed", "0.41", "--trials", FOLDER)
        late_talk = Talk(late)
        late_talk.ask(do="record", on=True, subject="LATE")
        assert "next start" in late_talk.until(lambda m: m.get("type") == "recorder" and m["recorder"], "recording")["recorder"]["note"]
        host.send_signal(signal.SIGTERM)
        host.wait(60)
        host = begin_host()
        late_talk.event("boot")
        seen = late_talk.rows
        while late_talk.rows < seen + 3000:
            late_talk.hear()
        late_talk.ask(do="record", on=False)
        late_talk.until(lambda m: m.get("type") == "trials" and kept(m, "LATE"), "kept")
    finally:
        for process in (host, walker):
            process.send_signal(signal.SIGTERM)
            process.wait(60)
    assert view.end() == late.end() == 0
    folder = next(FOLDER.glob("*BUS"))
    done = subprocess.run([AFO, "replay", "--speed", "0.41", "--foreign-nodes", folder / "bus.log"], capture_output=True, text=True,
                          timeout=200, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    say("the trial replays from the boot of the controller")
    for code, what in (("MID", "one that began in the middle of a walk replays, too"), ("LATE", "one of a late view from the next start")):
        replays(next(FOLDER.glob(f"*{code}")))
        say(what)
    say("done")
    return 0


if __name__ == "__main__":
    sys.exit(main())
