"""What a browser may change: every change is an SDO write over the bus, read back; like any other tool's.

canopen speaks SDO by the controller's EDS; here it gets the source's frames and gives its own to the source.
"""
import asyncio
import concurrent.futures
import struct

import canopen

from refusal import Refusal

NODE = 16
FIRST_CLIENT, CLIENTS = 101, 26  # `afo ctl' is client 100
ANSWER_S, RAMP_S, REQUEST_S, COUNTERS_S = 2.0, 8.0, 6.0, 10.0
GROUPS = ("commands.desired_apex_speed", "parameters.")
UNDO_MAX = 200
# What limits a setting over the bus, beside its range: other parameters (controller/control_params.h).
BORNE = {"kp_m_s_rad": ("kp_low_m_s_rad", "kp_high_m_s_rad"), "r0_max_m": (None, "r0_ceiling_m"),
         "r0_change_max_m": (None, "r0_change_ceiling_m")}
LAW_WORDS = {"kp_m_s_rad": "gain proportional settling", "speed_ramp_rad_s": "ramp settling acceleration",
             "r0_change_max_m": "limit", "r0_max_m": "limit", "r0_min_m": "limit", "law": "controller"}
# CiA 301 abort codes in words, and what to do: as `afo ctl' says it.
ABORTS = {
    0x05030000: ("the transfer lost its place", "another tool speaks with this node: try again"),
    0x05040000: ("the node gave the transfer up", "try again"),
    0x06010000: ("the node does not allow it", "it may be locked"),
    0x06010002: ("it can only be read", "it is measured or fixed"),
    0x06020000: ("the node has no such object", "is the firmware as new as this program?"),
    0x06090030: ("the value does not fit the other settings", "change the others first"),
    0x06090031: ("the value is too high", "choose a lower one; a gain must be one that this walker's gaits bear"),
    0x06090032: ("the value is too low", "choose a higher one; a gain must be one that this walker's gaits bear"),
    0x08000020: ("the node cannot keep it", "a controller on a PC keeps no settings"),
    0x08000022: ("not in this state", "stop first, stand still, and try again"),
}


class BusNetwork(canopen.Network):
    """canopen's network on any source of frames."""

    def __init__(self, source):
        super().__init__()
        self.source = source

    def send_message(self, can_id, data, remote=False):
        self.source.send(can_id, bytes(data).ljust(8, b"\0"))


class Control:
    def __init__(self, site):
        self.site, self.hub, self.objects = site, site.hub, site.hub.objects
        network = BusNetwork(site.source)
        self.node = canopen.RemoteNode(NODE, canopen.import_od(str(self.objects.eds), NODE))
        self.node.sdo.RESPONSE_TIMEOUT = ANSWER_S
        network.add_node(self.node)
        self.network = network
        self.worker = concurrent.futures.ThreadPoolExecutor(1, "sdo")
        self.turn = asyncio.Lock()
        self.values, self.undo, self.numbers, self.tasks = {}, [], {}, set()
        self.hub.listeners.append(self._hear)
        site.deeds.update({"write": self.do_write, "undo": self.do_undo, "request": self.do_request})
        site.hello_parts.append(self.hello)

    def start(self):
        self.keep(self._look())

    def keep(self, work):
        task = asyncio.ensure_future(work)
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)

    def _hear(self, records):
        for place in (records["id"] == 0x580 + NODE).nonzero()[0]:
            self.network.notify(0x580 + NODE, bytearray(records["data"][place].tobytes()), 0.0)

    # ---- over the bus ---------------------------------------------------------------

    async def _run(self, deed, *arguments):
        return await asyncio.get_running_loop().run_in_executor(self.worker, deed, *arguments)

    async def read(self, entry):
        data = await self._run(self.node.sdo.upload, entry["index"], entry["sub"])
        return self.objects.number(entry, bytes(data))

    async def put(self, name, value):
        entry = self.objects.find(name)
        await self._run(self.node.sdo.download, entry["index"], entry["sub"], self.objects.pack(entry, value))

    def settings(self):
        chosen = [one for name, one in self.objects.by_name.items() if name.startswith(GROUPS) and one["type"]]
        return [{**one, "value": self.values.get(one["name"]), "words": LAW_WORDS.get(one["name"].split(".")[-1], ""),
                 "bus": self._borne(one["name"])} for one in chosen]

    def _borne(self, name):
        """[low, high] of what may be written over the bus for this person, None where the range alone counts."""
        low, high = BORNE.get(name.split(".")[-1], (None, None))
        value = [self.values.get(f"parameters.{one}") if one else None for one in (low, high)]
        return value if value[1] else None

    async def _look(self):
        """All values once, then the counters again and again; spaced, for others ask, too."""
        while True:
            try:
                for one in self.settings():
                    if one["name"] not in self.values:
                        async with self.turn:
                            self.values[one["name"]] = await self.read(one)
                self.tell_values()
                await self._counters()
            except (canopen.SdoCommunicationError, canopen.SdoAbortedError, OSError):
                await asyncio.sleep(1.0)  # not there yet, or gone: seen elsewhere
            await asyncio.sleep(COUNTERS_S)

    async def _counters(self):
        found = {}
        for name, one in self.objects.by_name.items():
            if name.startswith("counters."):
                async with self.turn:
                    value = await self.read(one)
                if value or "missed_ticks" in name or "late" in name:
                    found[one["meaning"]] = value
                await asyncio.sleep(0.05)
        self.hub.tell({"type": "counters", "values": found})

    # ---- what is asked ----------------------------------------------------------------

    def hello(self):
        return {"settings": self.settings(), "can_restart": hasattr(self.site.source, "restart")}

    def tell_values(self):
        borne = {name: self._borne(name) for name in self.values if self._borne(name)}
        self.hub.tell({"type": "values", "values": self.values, "bus": borne})
        last = self.undo[-1] if self.undo else (None, None)
        self.hub.tell({"type": "undo", "name": last[0], "value": last[1]})

    def _number_of(self, client):
        if client not in self.numbers:
            self.numbers[client] = FIRST_CLIENT + len(self.numbers) % CLIENTS
        return self.numbers[client]

    def _idle(self):
        """While a step of commissioning moves motors nothing else is asked of the controller."""
        under_way = self.site.commissioning.step if self.site.commissioning else None
        if under_way:
            raise Refusal(f"The step {under_way} of commissioning is under way: interrupt it first.")

    def do_write(self, client, asked):
        self._idle()
        name, value = str(asked["name"]), float(asked["value"])
        entry = self.objects.by_name.get(name)
        if entry is None or not name.startswith(GROUPS) or entry["access"] != "rw":
            raise Refusal(f"{name} is no setting that can be changed here.")
        low, high = entry.get("low"), entry.get("high")
        if value != value or (low is not None and not low <= value <= high):
            raise Refusal(f"{name} = {value:g} was not written: allowed is {low:g} to {high:g} {entry['unit'] or ''}")
        self.keep(self._guarded(client, "write", self._write(client, entry, value, True)))

    def do_undo(self, client, _):
        self._idle()
        if not self.undo:
            raise Refusal("There is nothing to undo.")
        name, before = self.undo.pop()
        self.keep(self._guarded(client, "undo", self._write(client, self.objects.by_name[name], before, False)))

    def do_request(self, client, asked):
        what = asked["what"]
        deed = {"walk": self._walk, "stop": self._stop, "reset": self._reset, "zero": self._zero,
                "restart": self._restart}[what]
        if what == "stop" and self.site.commissioning:
            self.site.commissioning.interrupt()
        else:
            self._idle()
        self.keep(self._guarded(client, "request", deed(client)))

    def mark(self, client, number):
        """The mark's number to the controller, whose board gives a pulse; its frame's time in the log is the pulse's."""
        if self.objects.find("commands.mark") is None:
            return
        try:
            self._idle()
        except Refusal as refusal:
            self._tell_refusal(client, "mark", f"No sync pulse for mark {number}. {refusal}")
            return
        self.keep(self._guarded(client, "mark", self.put("commands.mark", number)))

    def _tell_refusal(self, client, do, text):
        """To the browser that asked; what a packet asked for is told to all."""
        if client is None:
            self.hub.trouble(text)
        else:
            client.put({"type": "refused", "do": do, "text": text})

    async def _guarded(self, client, do, work):
        """One after the other, and what goes wrong goes to the browser that asked."""
        try:
            async with self.turn:
                await work
        except Refusal as refusal:
            self._tell_refusal(client, do, str(refusal))
        except canopen.SdoAbortedError as error:
            words, remedy = ABORTS.get(error.code, ("unknown reason", "look the code up in the node's manual"))
            self._tell_refusal(client, do, f"Refused: {words} (0x{error.code:08X}); {remedy}.")
            self.tell_values()
        except (canopen.SdoCommunicationError, OSError) as error:
            self._tell_refusal(client, do, f"The controller does not answer ({error}). Is it running?")

    async def _write(self, client, entry, value, may_undo):
        before = await self.read(entry)
        if entry["index"] == 0x2010:
            key = int.from_bytes(b"set", "little") | self._number_of(client) << 24
            await self._run(self.node.sdo.download, 0x2000, 5, struct.pack("<I", key))
        await self.put(entry["name"], value)
        if may_undo:
            self.undo = [*self.undo[-UNDO_MAX + 1:], (entry["name"], before)]
        read = self.values[entry["name"]] = await self.read(entry)
        wanted = self.objects.number(entry, self.objects.pack(entry, value))
        note = "" if read == wanted else "It moves there within 5 s"
        self.hub.tell({"type": "written", "name": entry["name"], "before": before, "value": value, "read": read,
                       "unit": entry["unit"], "note": note})
        self.tell_values()
        if read != wanted:
            self.keep(self._follow(entry, before, value, wanted))

    async def _follow(self, entry, before, value, wanted):
        """A gain moves to its new value; its arrival is read back, too."""
        for _ in range(int(RAMP_S / 0.5)):
            await asyncio.sleep(0.5)
            async with self.turn:
                read = self.values[entry["name"]] = await self.read(entry)
            if read == wanted:
                break
        note = "Arrived" if read == wanted else "It did not arrive: was it changed again?"
        self.hub.tell({"type": "written", "name": entry["name"], "before": before, "value": value, "read": read,
                       "unit": entry["unit"], "note": note})
        self.tell_values()

    # ---- requests ---------------------------------------------------------------------------

    async def _until(self, condition):
        for _ in range(int(REQUEST_S / 0.05)):
            if condition():
                return True
            await asyncio.sleep(0.05)
        return False

    def _say(self, client, what, done, otherwise):
        state = self.hub.state_words()
        text = f"done: {state['state']}" if done else f"{otherwise}; state: {state['state']}, fault: {state['fault']['name']}"
        client.put({"type": "request", "what": what, "text": text})

    async def _walk(self, client):
        await self.put("commands.walk_requested", 0)
        await asyncio.sleep(0.1)
        await self.put("commands.walk_requested", 1)
        done = await self._until(lambda: self.hub.state_words()["state"] in ("engaging", "walking"))
        self._say(client, "walk", done, "asked for, and not begun: it needs standby, without a fault")

    async def _stop(self, client):
        await self.put("commands.walk_requested", 0)
        done = await self._until(lambda: self.hub.state_words()["state"] in ("standby", "FAULT", "waiting for the nodes"))
        self._say(client, "stop", done, "asked for; the springs are not yet unloaded")

    async def _reset(self, client):
        await self.put("commands.reset_fault", 1)
        done = await self._until(lambda: not self.hub.fault_number)
        self._say(client, "reset", done, "not reset: stand still, and mend what the fault says")

    async def _zero(self, client):
        await self.put("commands.zero_the_leg_sensors", 1)
        state = self.objects.find("zeroing")
        for _ in range(40):
            await asyncio.sleep(0.1)
            outcome = await self.read(state)
            if outcome != 1:
                break
        self._say(client, "zero", outcome == 2, f"refused (outcome {outcome}): stand still, without torque, and try again")

    async def _restart(self, client):
        if not hasattr(self.site.source, "restart"):
            raise Refusal("Only the walker in this process can begin anew.")
        self.site.source.restart()
        self.values.clear()
        self.undo.clear()
        client.put({"type": "request", "what": "begin anew", "text": "everything is switched off and on"})
