"""CAN logs of other tools, read by python-can, written as candump -L writes them: what afo replay and afo view read."""
import collections
import re

from walk_source import Refusal, listed

NAME = re.compile(r"[!-~]{1,15}$")


def is_peak(path):
    """A .trc of PEAK's tools, and not OpenSim's markers: it begins with ;$FILEVERSION or ;## comments."""
    with open(path, "rb") as file:
        return file.read(64).lstrip().startswith(b";")


def frames(path):
    """(seconds, channel, frame) in the log's order."""
    import can
    try:
        with can.LogReader(str(path)) as reader:
            return [message for message in reader if not message.is_error_frame]
    except OSError as error:
        raise Refusal(error.strerror or str(error)) from error
    except Exception as error:  # each of python-can's readers has errors of its own
        raise Refusal(f"python-can cannot read it: {error!r}") from None


def name_of(channel):
    text = str(channel)
    return f"can{text}" if text.isdigit() or text == "None" else text


def line_of(message, name):
    micros = round(message.timestamp * 1e6)
    identifier = f"{message.arbitration_id:08X}" if message.is_extended_id else f"{message.arbitration_id:03X}"
    data = f"R{message.dlc or ''}" if message.is_remote_frame else bytes(message.data).hex().upper()
    return f"({micros // 1000000:010d}.{micros % 1000000:06d}) {name} {identifier}#{data}\n"


def read(path, interface):
    """(text of the log, words). interface: the one to take, by its name; None: all of them."""
    found = frames(path)
    if not found:
        raise Refusal("there is no frame in it")
    if any(message.is_fd for message in found):
        raise Refusal("it has CAN FD frames: the orthosis bus is classic CAN")
    if any(message.timestamp < 0 for message in found):
        raise Refusal("it has frames before its own time 0")
    counts = collections.Counter(name_of(message.channel if message.channel is not None else 0) for message in found)
    bad = next((name for name in counts if not NAME.match(name)), None)
    if bad:
        raise Refusal(f"its interface is called {bad!r}, which no candump log can hold: 15 characters without blanks at most")
    if interface is not None and interface not in counts:
        raise Refusal(f"it has no interface {interface}, but {listed(counts)}: --interface NAME")
    lines, kept = [], 0
    for message in found:
        name = name_of(message.channel if message.channel is not None else 0)
        if interface in (None, name):
            lines.append(line_of(message, name))
            kept += 1
    told = ", ".join(f"{name} ({count} frames)" for name, count in counts.items())
    return "".join(lines), f"{kept} frames of {interface or 'all interfaces'}; in the file: {told}"
