"""Runs where vcan0 is, during a walk: the package canopen as a person's tool on node 16,
and frames that no healthy node sends. Every line printed is a check that held."""
import struct
import subprocess
import sys
import time

import canopen

EDS = "hal/canopen/eds/"


def say(text):
    print(text, flush=True)


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


def cansend(*frames):
    for frame in frames:
        subprocess.run(["cansend", "vcan0", frame], check=True)


def main():
    network = canopen.Network()
    # Only what is for it: a whole walk in lock-step is too much for a script.
    filters = [{"can_id": identifier, "can_mask": 0x7FF} for identifier in (0x590, 0x710)]
    network.connect(interface="socketcan", channel="vcan0", can_filters=filters)
    node = canopen.RemoteNode(16, canopen.import_od(EDS + "controller.eds", 16))
    node.sdo.RESPONSE_TIMEOUT = 20.0
    network.add_node(node)
    try:
        wait_for(lambda: node.sdo[0x2003][1].raw >= 2, 120, "two steps")
        assert "AFO controller" in node.sdo["Manufacturer device name"].raw
        before = node.sdo[0x2003][3].raw
        say("a walk goes on and its steps can be read")
        assert abort_code(lambda: node.sdo.download(0x2000, 1, struct.pack("<f", 99.0))) \
            in (0x06090031, 0x06090030)
        assert abort_code(lambda: node.sdo.download(0x2000, 1, struct.pack("<f", float("nan")))) \
            in (0x06090030, 0x06090031, 0x06090032)
        assert abort_code(lambda: node.sdo.download(0x2000, 1, struct.pack("<f", 1.16))) == 0x06090031
        assert abort_code(lambda: node.sdo.download(0x2000, 1, struct.pack("<f", 0.05))) == 0x06090032
        assert abort_code(lambda: node.sdo.download(0x2000, 2, b"\x07")) == 0x06090031
        say("what is out of range is refused")
        node.sdo[0x2000][1].raw = before + 0.02
        steps = node.sdo[0x2003][1].raw
        wait_for(lambda: node.sdo[0x2003][1].raw >= steps + 2, 120, "two more steps")
        assert node.sdo[0x2003][3].raw > before
        say("the desired speed is changed during the walk")
        counters = node.sdo[0x2020]
        assert counters["Ticks"].raw > 600
        assert [counters[name].raw for name in ("Foreign frames", "Malformed frames", "Forced stops",
                                                "Missed ticks", "Times bus-off")] == [0] * 5
        cansend("181#", "181#11223344556677", "283#01", "283#R", "00000181#112233445566",
                "581#00", "601#2B4060", "000#81", "701#0505", "20000004#0000000000000000",
                "082#1081110000000000")
        steps = node.sdo[0x2003][1].raw
        wait_for(lambda: node.sdo[0x2003][1].raw >= steps + 1, 120, "a step after bad frames")
        assert node.sdo[0x2001][2].raw == 0
        assert counters["Malformed frames"].raw == 3    # 0x181 twice, 0x283: the others reach it not
        say("malformed frames do not end the walk")
        cansend("201#0000000000000000")
        wait_for(lambda: node.sdo[0x2001][2].raw == 18, 60, "a foreign node on the bus")
        wait_for(lambda: node.sdo[0x2001][1].raw & 0x7F == 6, 60, "unloaded and off")
        assert counters["Foreign frames"].raw > 0 and counters["Forced stops"].raw > 0
        say("another node's targets end the walk")
    finally:
        network.disconnect()
    say("done")
    return 0


if __name__ == "__main__":
    sys.exit(main())
