"""Runs where vcan0 is (scripts/vcan-guest): the package canopen as master of afo walker.

Every line it prints is a check that held; the last one is "done". tests/system/test_peers.py
starts it and afo walker and reads the lines.
"""
import struct
import sys
import threading
import time

import canopen
from canopen.profiles.p402 import BaseNode402

EDS = "hal/canopen/eds/"

# The package's patience is for a bus of its own, not for a guest on a busy machine.
BaseNode402.TIMEOUT_SWITCH_STATE_FINAL = 20.0
BaseNode402.TIMEOUT_SWITCH_STATE_SINGLE = 10.0
BaseNode402.TIMEOUT_CHECK_TPDO = 10.0


def say(text):
    print(text, flush=True)


def abort_code(action):
    try:
        action()
    except canopen.SdoAbortedError as error:
        return error.code
    raise AssertionError("was not refused")


def heartbeats(network, stop):
    """The master's own heartbeat, node 16."""
    while not stop.wait(0.1):
        network.send_message(0x710, [5])


def scan(network):
    network.scanner.search(limit=20)
    deadline = time.time() + 20
    while len(network.scanner.nodes) < 4 and time.time() < deadline:
        time.sleep(0.2)
    assert sorted(network.scanner.nodes) == [1, 2, 3, 4], network.scanner.nodes
    say("scan finds nodes 1 to 4")


def sdo(node, sensor):
    assert node.sdo[0x1000].raw == 0x00020192
    assert node.sdo["Manufacturer device name"].raw == "AFO virtual SEA drive"
    assert sensor.sdo["Manufacturer device name"].raw == "AFO virtual leg sensor"
    say("expedited and segmented uploads by EDS")
    node.sdo[0x6065].raw = 123456
    assert node.sdo[0x6065].raw == 123456
    assert abort_code(lambda: node.sdo.download(0x6007, 0, struct.pack("<h", 9))) == 0x06090031
    assert abort_code(lambda: node.sdo.download(0x6060, 0, b"\x01")) == 0x06090030
    assert abort_code(lambda: node.sdo.download(0x6041, 0, b"\0\0")) == 0x06010002
    assert abort_code(lambda: node.sdo.upload(0x7123, 0)) == 0x06020000
    assert abort_code(lambda: node.sdo.upload(0x607D, 9)) == 0x06090011
    assert abort_code(lambda: node.sdo.download(0x6065, 0, b"\0")) == 0x06070013
    say("downloads, and refusals with their codes")


def remap(node):
    node.tpdo.read()
    pdo = node.tpdo[4]
    pdo.clear()
    pdo.add_variable("Position actual value")
    pdo.add_variable("Following error actual value")
    pdo.trans_type = 2
    pdo.cob_id = 0x481
    pdo.enabled = True
    pdo.save()
    node.nmt.state = "OPERATIONAL"
    before = time.time()
    assert pdo.wait_for_reception(timeout=20) is not None and time.time() - before < 20
    assert len(pdo.data) == 8
    say("a TPDO mapped by SDO arrives")


def state_machine(node):
    node.setup_402_state_machine(read_pdos=True)
    for state in ("READY TO SWITCH ON", "SWITCHED ON", "OPERATION ENABLED"):
        node.state = state
        assert node.state == state, (node.state, state)
    assert node.op_mode == "CYCLIC SYNCHRONOUS POSITION", node.op_mode
    say("the CiA 402 state machine up to OPERATION ENABLED")
    node.state = "SWITCH ON DISABLED"
    assert node.state == "SWITCH ON DISABLED", node.state
    for state in ("READY TO SWITCH ON", "SWITCHED ON", "OPERATION ENABLED"):
        node.state = state
    say("and down and up again")


def lost_master(node, stop):
    node.emcy.reset()
    stop.set()
    emcy = node.emcy.wait(0x8130, timeout=20)
    assert emcy is not None and emcy.register & 0x10, emcy
    deadline = time.time() + 20
    while node.sdo[0x6041].raw & 0x4F != 0x08 and time.time() < deadline:
        time.sleep(0.05)
    assert node.sdo[0x6041].raw & 0x4F == 0x08
    assert node.sdo[0x603F].raw == 0x8130
    assert node.sdo[0x1001].raw & 0x11 == 0x11
    assert node.sdo[0x1003][1].raw & 0xFFFF == 0x8130
    say("a lost master is an emergency, a fault and a line of the history")


def main():
    network = canopen.Network()
    network.connect(interface="socketcan", channel="vcan0")
    stop = threading.Event()
    try:
        scan(network)
        node = BaseNode402(1, canopen.import_od(EDS + "drive-left.eds", 1))
        sensor = canopen.RemoteNode(3, canopen.import_od(EDS + "sensor-left.eds", 3))
        for one in (node, sensor):
            one.sdo.RESPONSE_TIMEOUT = 20.0
            network.add_node(one)
        assert node.nmt.wait_for_heartbeat(timeout=20) == "PRE-OPERATIONAL"
        say("heartbeat says PRE-OPERATIONAL")
        sdo(node, sensor)
        threading.Thread(target=heartbeats, args=(network, stop), daemon=True).start()
        network.sync.start(0.01)
        remap(node)
        assert node.nmt.wait_for_heartbeat(timeout=20) == "OPERATIONAL"
        state_machine(node)
        lost_master(node, stop)
        states = []
        node.nmt.add_heartbeat_callback(states.append)
        node.nmt.state = "RESET"
        deadline = time.time() + 20
        while 0 not in states and time.time() < deadline:
            time.sleep(0.05)
        assert 0 in states, states
        say("boot-up after a reset")
    finally:
        stop.set()
        network.sync.stop()
        network.disconnect()
    say("done")
    return 0


if __name__ == "__main__":
    sys.exit(main())
