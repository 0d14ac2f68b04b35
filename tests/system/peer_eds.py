"""Runs where vcan0 is: the package canopen reads every object of some nodes that was given a default by
their data sheets, and compares. Arguments: pairs of node number and data sheet. The last line is "done"."""
import struct
import sys

import canopen

REAL32 = 0x08


def variables(od):
    for entry in od.values():
        if isinstance(entry, canopen.objectdictionary.ODVariable):
            if entry.index >= 0x1000:  # below: dummies of the mapping
                yield entry
        else:
            yield from (entry[sub] for sub in entry.subindices if sub in entry)


def same(variable, raw):
    if variable.data_type == REAL32:
        return raw == struct.pack("<f", variable.default)
    return variable.decode_raw(raw) == variable.default


def compare(network, number, sheet):
    od = canopen.import_od(sheet, number)
    node = canopen.RemoteNode(number, od)
    node.sdo.RESPONSE_TIMEOUT = 20.0
    network.add_node(node)
    compared = 0
    for variable in variables(od):
        if not getattr(variable, "default_raw", "") or variable.access_type == "wo":
            continue
        raw = node.sdo.upload(variable.index, variable.subindex)
        if same(variable, raw):
            compared += 1
        else:
            print(f"node {number}, {sheet}: 0x{variable.index:04X}:{variable.subindex} {variable.name}: "
                  f"default {variable.default}, the node says {raw.hex()}")
    print(f"{sheet}: {compared} defaults are the node's", flush=True)
    return compared


def main(arguments):
    network = canopen.Network()
    filters = [{"can_id": 0x580 + int(number), "can_mask": 0x7FF} for number in arguments[::2]]
    network.connect(interface="socketcan", channel="vcan0", can_filters=filters)
    try:
        for number, sheet in zip(arguments[::2], arguments[1::2]):
            assert compare(network, int(number), sheet) > 20
    finally:
        network.disconnect()
    print("done")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
