"""Runs where vcan0 is, during a walk: what afo ctl writes the package canopen reads, and the other way
round. Every line printed is a check that held. Arguments: the program afo, a folder for files."""
import json
import pathlib
import signal
import struct
import subprocess
import sys
import time

import canopen

AFO, FOLDER = sys.argv[1], pathlib.Path(sys.argv[2])


def say(text):
    print(text, flush=True)


def ctl(*words, status=0):
    done = subprocess.run([AFO, "ctl", "--can", "vcan0", *words], capture_output=True, text=True, timeout=120,
                          check=False)
    assert done.returncode == status, (words, done.returncode, done.stdout, done.stderr)
    time.sleep(0.3)  # the other tool hears these answers, too, and drops what waits when it asks next
    return done


def values(*words):
    return json.loads(ctl("--json", "get", *words).stdout)


def abort_code(action):
    try:
        action()
    except canopen.SdoAbortedError as error:
        return error.code
    raise AssertionError("was not refused")


def wait_for(condition, seconds, what):
    deadline = time.time() + seconds
    while not condition():
        assert time.time() < deadline, f"did not happen: {what}"
        time.sleep(0.2)


def main():
    network = canopen.Network()
    network.connect(interface="socketcan", channel="vcan0", can_filters=[{"can_id": 0x590, "can_mask": 0x7FF}])
    node = canopen.RemoteNode(16, canopen.import_od("hal/canopen/eds/controller.eds", 16))
    node.sdo.RESPONSE_TIMEOUT = 20.0
    network.add_node(node)
    try:
        wait_for(lambda: node.sdo[0x2003][1].raw >= 2, 120, "two steps")
        ctl("set", "kp_m_s_rad=0.046875")
        wait_for(lambda: node.sdo[0x2010]["kp_m_s_rad"].raw == 0.046875, 240, "a gain that comes by a ramp")
        assert node.sdo[0x2004][2].raw == 100 and node.sdo[0x2004][5].raw == 0.046875    # who changed it, to what
        assert abort_code(lambda: node.sdo.download(0x2010, 7, struct.pack("<f", 1.0))) == 0x06090031
        node.sdo[0x2000][5].raw = 0
        assert abort_code(lambda: node.sdo.download(0x2010, 7, struct.pack("<f", 0.045))) == 0x08000022
        node.sdo[0x2000][5].raw = 0x07746573    # "set", client 7
        node.sdo[0x2010]["kp_m_s_rad"].raw = 0.044921875
        wait_for(lambda: node.sdo[0x2010]["kp_m_s_rad"].raw == 0.044921875, 240, "another gain")
        assert node.sdo[0x2001][7].raw == 7 and node.sdo[0x2004][2].raw == 7
        told = values("kp_m_s_rad", "state", "0x1009")
        assert told["parameters.kp_m_s_rad"] == {"value": 0.044921875, "unit": "m/(rad/s)"}
        assert told["state.supervisor_state_and_emergency_stop"]["name"] == "walking"
        assert told["manufacturer_hardware_version"]["value"] == "1"
        say("each reads what the other has written")
        done = ctl("set", "kp_m_s_rad=3", status=1)
        assert "too high" in done.stderr and "0 .. 1 m/(rad/s)" in done.stderr
        done = ctl("get", "0x5000:01", status=1)
        assert "no such object (0x06020000)" in done.stderr
        say("refusals are told")
        dump = FOLDER / "dump.ini"
        dump.write_text(ctl("dump").stdout)
        ctl("diff", str(dump))
        node.sdo[0x2000][5].raw = 0x07746573
        node.sdo[0x2010]["r0_change_max_m"].raw = 0.01
        wait_for(lambda: abs(node.sdo[0x2010]["r0_change_max_m"].raw - 0.01) < 1e-6, 240, "a limit by a ramp")
        assert "parameters.r0_change_max_m: file " in ctl("diff", str(dump), status=1).stdout
        say("a dump equals the device, and diff finds what was changed")
        with subprocess.Popen([AFO, "ctl", "--can", "vcan0", "--json", "--period", "50", "watch", "counters.ticks"],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as watch:
            seen = [json.loads(watch.stdout.readline())["counters.ticks"]["value"] for _ in range(3)]
            watch.send_signal(signal.SIGINT)
            _, errors = watch.communicate(timeout=20)
        assert watch.returncode == 0 and not errors, (watch.returncode, errors)
        assert seen[0] < seen[1] < seen[2] <= node.sdo[0x2020]["Ticks"].raw
        say("watch prints what changes, and ends at Ctrl-C")
        assert ctl("stop").stdout == "standby\n"
        assert node.sdo[0x2000][2].raw == 0 and node.sdo[0x2001][1].raw == 2
        assert ctl("walk").stdout in ("engaging\n", "walking\n")
        wait_for(lambda: node.sdo[0x2001][1].raw in (3, 4), 20, "it engages")
        say("stop and walk do what they say")
    finally:
        network.disconnect()
    say("done")
    return 0


if __name__ == "__main__":
    sys.exit(main())
