"""The controller's objects by name, with units, ranges and meaning: what `afo ctl names' says, and the EDS' types."""
import json
import pathlib
import re
import struct
import subprocess

TYPES = {1: "?", 2: "b", 3: "h", 4: "i", 5: "B", 6: "H", 7: "I", 8: "f"}


class Objects:
    """by_name[name] -> {name, index, sub, type, unit, low, high, meaning, access, scale}"""

    def __init__(self, afo, eds):
        said = subprocess.run([afo, "ctl", "--json", "names"], capture_output=True, text=True, check=True).stdout
        types = eds_types(pathlib.Path(eds).read_text(encoding="utf-8"))
        self.eds = eds
        self.by_name, self._by_address = {}, {}
        for name, one in json.loads(said).items():
            index, sub = (int(part, 16) for part in one["address"].split(":"))
            kind = types.get((index, sub))
            entry = {"name": name, "index": index, "sub": sub, "type": TYPES.get(kind), "scale": scale_of(one["meaning"]),
                     **one}
            self.by_name[name] = self._by_address[index, sub] = entry

    def by_address(self, index, sub):
        return self._by_address.get((index, sub))

    def find(self, name):
        """By the whole name, or by the part behind the point where only one has it."""
        if name in self.by_name:
            return self.by_name[name]
        found = [one for key, one in self.by_name.items() if key.split(".")[-1] == name]
        return found[0] if len(found) == 1 else None

    @staticmethod
    def number(entry, data):
        """What bytes mean, in the unit shown; text of bytes that are no number."""
        kind = entry["type"]
        if kind is None or len(data) < struct.calcsize(kind):
            return data.hex()
        value = struct.unpack_from("<" + kind, data)[0]
        if kind == "f":
            return plain(value)
        return value * entry["scale"] if entry["scale"] != 1 else value

    @staticmethod
    def pack(entry, value):
        kind = entry["type"]
        if kind == "f":
            return struct.pack("<f", value)
        return struct.pack("<" + kind, round(value / entry["scale"]))


def plain(value):
    """The number that a person would have written for this float."""
    for digits in range(6, 10):
        text = f"{value:.{digits}g}"
        if struct.unpack("<f", struct.pack("<f", float(text)))[0] == value:
            break
    return float(text)


def scale_of(meaning):
    """Units at the end of a name, such as "Precompression 10 um"; floats are in SI units already."""
    match = re.search(r"(\d+(?:\.\d+)?) (mrad/s|um|mV|degC)$", meaning)
    factor = {"mrad/s": 1e-3, "um": 1e-6, "mV": 1e-3, "degC": 1.0}
    return float(match[1]) * factor[match[2]] if match else 1


def eds_types(text):
    types, section = {}, None
    for line in text.splitlines():
        head = re.match(r"\[([0-9A-F]{4})(?:sub([0-9A-F]+))?\]", line, re.IGNORECASE)
        if line.startswith("["):
            section = (int(head[1], 16), int(head[2] or "0", 16)) if head else None
        elif section and line.startswith("DataType="):
            types[section] = int(line.split("=")[1], 0)
    return types
