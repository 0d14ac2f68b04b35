"""Runs where vcan0 and vcan1 are, during a walk: node 3, the left leg's sensor, is the package canopen's LocalNode.

The walker's nodes are on vcan1, the controller and the package's node on vcan0. This script carries the
frames between them, but none of node 3's: what its own frame on vcan1 says of the leg goes into the package's
object dictionary, and the package does the rest by itself: SDO server, network management, heartbeat, and the
PDO as the controller has mapped it. Arguments: --steps-per-turn N gives it another resolution.
Ends with SIGTERM, and says what the controller made of the node.
"""
import argparse
import select
import signal
import socket
import struct
import sys

import canopen

NODE = 3
FRAME = struct.Struct("=IB3x8s")
OWN = {0x080 + NODE, 0x180 + NODE, 0x280 + NODE, 0x580 + NODE, 0x600 + NODE, 0x700 + NODE}
LEG_STATE = 0x280 + NODE


def open_raw(name):
    port = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    port.bind((name,))
    return port


class Sensor:
    """The package's node, and how it came to be what it is."""

    def __init__(self, network, steps_per_turn):
        self.node = canopen.LocalNode(NODE, canopen.import_od("hal/canopen/eds/sensor-left.eds", NODE))
        network.add_node(self.node)
        self.written, self.sent, self.pdo = [], 0, None
        for index in (0x2021, 0x6503):    # a linear ankle, no alarms: its data sheet leaves both open
            self.node.sdo[index].raw = 0
        self.node.add_write_callback(self.note)
        if steps_per_turn is not None:
            self.node.data_store[0x6001] = {0: struct.pack("<I", steps_per_turn)}
        self.node.nmt.state = "INITIALISING"
        self.node.nmt.state = "PRE-OPERATIONAL"

    def note(self, index, subindex, data, **_):
        if index not in (0x2020, 0x6503):
            self.written.append((index, subindex, bytes(data)))
            self.pdo = None    # perhaps mapped anew

    def measure(self, data):
        """A sample of the walker's sensor: into the objects, and out by the PDO that maps them."""
        if self.node.nmt.state != "OPERATIONAL":
            return
        if self.pdo is None:
            self.node.tpdo.read()
            self.pdo = self.node.tpdo[2]
        if not self.pdo.enabled or self.pdo.trans_type != 1:
            return
        values = {1: int.from_bytes(data[:3], "little", signed=True),
                  2: int.from_bytes(data[3:5], "little", signed=True)}
        for variable in self.pdo:
            variable.raw = values[variable.subindex]
        self.pdo.transmit()
        self.sent += 1


def carry(sensor, here, there, going):
    while going:
        ready, _, _ = select.select([here, there], [], [], 0.1)
        for port in ready:
            raw = port.recv(16)
            identifier, length, data = FRAME.unpack(raw)
            if identifier not in OWN:
                (there if port is here else here).send(raw)
            elif port is there and identifier == LEG_STATE:
                sensor.measure(data[:length])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--steps-per-turn", type=int)
    arguments = parser.parse_args()
    going = [True]
    signal.signal(signal.SIGTERM, lambda *_: going.clear())
    network = canopen.Network()
    network.connect(interface="socketcan", channel="vcan0",
                    can_filters=[{"can_id": identifier, "can_mask": 0x7FF} for identifier in (0, 0x600 + NODE)])
    here, there = open_raw("vcan0"), open_raw("vcan1")
    sensor = Sensor(network, arguments.steps_per_turn)
    try:
        carry(sensor, here, there, going)
    finally:
        network.disconnect()
    objects = sorted({f"0x{index:04X}:{sub}" for index, sub, _ in sensor.written})
    print("written:", " ".join(objects))
    print("heartbeat:", sensor.node.sdo[0x1017].raw, "ms")
    print("state:", sensor.node.nmt.state)
    print("PDOs:", sensor.sent)
    return 0


if __name__ == "__main__":
    sys.exit(main())
