"""Runs where vcan0 is: afo view on a bus, as the only one who watches and as one who changes. Every line printed is a check
that held. Arguments: the program afo, a folder for files."""
import pathlib
import signal
import subprocess
import sys
import time

from viewer import Talk, View

AFO, FOLDER = sys.argv[1], pathlib.Path(sys.argv[2])


def say(text):
    print(text, flush=True)


def ctl(*words):
    done = subprocess.run([AFO, "ctl", "--can", "vcan0", *words], capture_output=True, text=True, timeout=200, check=False)
    assert done.returncode == 0, (words, done.stdout, done.stderr)
    return done.stdout


def main():
    view = View("--can", "vcan0", "--control", "--trials", FOLDER)
    talk = Talk(view)
    talk.ask(do="record", on=True, subject="BUS")
    talk.until(lambda m: m.get("type") == "recorder" and m["recorder"], "recording")
    walker = subprocess.Popen([AFO, "walker", "--can", "vcan0", "--silence", "60000", "--quiet"])
    time.sleep(0.3)
    host = subprocess.Popen([AFO, "host", "--can", "vcan0", "--speed", "0.41", "--quiet"])
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
        talk.ask(do="request", what="stop")
        assert "standby" in talk.until(lambda m: m.get("type") == "request", "stopped")["text"]
        say("stop is obeyed")
    finally:
        for process in (host, walker):
            process.send_signal(signal.SIGTERM)
            process.wait(60)
    talk.ask(do="record", on=False)
    talk.until(lambda m: m.get("type") == "trials" and m["trials"][0]["complete"], "kept")
    assert view.end() == 0
    folder = next(FOLDER.glob("*BUS"))
    done = subprocess.run([AFO, "replay", "--speed", "0.41", "--foreign-nodes", folder / "bus.log"], capture_output=True, text=True,
                          timeout=200, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    say("the trial replays from the boot of the controller")
    say("done")
    return 0


if __name__ == "__main__":
    sys.exit(main())
