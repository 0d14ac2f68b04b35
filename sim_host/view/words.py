"""What a state, a fault or an emergency is, in words, and what to do about it."""

# By controller/supervisor/supervisor.h; a test compares names and number.
FAULTS = {
    "none": ("No fault.", ""),
    "emergency stop": ("The emergency stop is pressed, or its wire is broken.",
                       "Find out why it was pressed. Release it, stand still, reset the fault, ask for the walk anew."),
    "node lost": ("A drive or sensor is silent, stopped, or reports an emergency.",
                  "Look at the emergencies below: which node? Check its supply and cable, then reset at standstill."),
    "leg sensor silent": ("A leg sensor's values are too old.",
                          "Check the sensor's cable and supply, and the bus load. Then reset at standstill."),
    "drive silent": ("A drive's values are too old.",
                     "Check the drive's cable and supply, and the bus load. Then reset at standstill."),
    "drive fault": ("A drive reports a fault, or switched itself off.",
                    "Read its emergency below, mend the cause (heat, supply, over-current). Reset at standstill."),
    "sensor out of range": ("A leg sensor reads what no leg can do.",
                            "Check how the sensor sits, and its zero (commission step zero). Then reset at standstill."),
    "leg beyond the fall angle": ("A leg is beyond the fall angle: the walker fell, or its sensor slipped.",
                                  "Look at the apex speed and r0 of the last steps: too slow or too fast before the fall? "
                                  "Lower the speed, or the gain. Then stand still, reset, and walk."),
    "bad parameters": ("The settings are not usable, or changed by themselves in memory.",
                       "Write the person's settings anew (afo settings) and restart the controller."),
    "sensor jumps": ("A leg sensor's value jumped as no motion does.",
                     "Check the sensor's cable, magnet and shield. Then reset at standstill."),
    "sensor stuck": ("A leg sensor does not change while the leg moves.",
                     "Check the sensor and how it sits on the leg. Then reset at standstill."),
    "spring implausible": ("Motor, ankle, latch and force contradict each other.",
                           "Do not load the spring. Look for a latch that opened or stuck, a broken spring, a slipping ankle."),
    "self test": ("Springs not slack, or values not fresh, at the start.",
                  "Unload the springs by hand if need be, check all nodes, reset."),
    "drive does not follow": ("A motor does not follow its command.",
                              "Is the motor blocked, too weak, too hot, or its supply low? See its temperature and voltage."),
    "legs disagree": ("The same leg carried the body twice in a row.",
                      "Are left and right sensors exchanged, or one stuck? Commission step sensors shows it."),
    "value not finite": ("A computation gave no number.",
                         "Keep the record and report it: this is a defect of the software."),
    "spring not unloaded in time": ("A spring was not known to be slack in time after a stop.",
                                    "Keep clear of the ankle. Check motor and supply before anything else."),
    "restarted by itself": ("The controller restarted by itself: crash or watchdog.",
                            "Read the black box (afo blackbox) and the crash record before the next walk."),
    "foreign node on the bus": ("Another node sends with the controller's identifiers.",
                                "Disconnect other masters and tools that send targets, SYNC or NMT. Then reset."),
    "a tool wrote to a drive or sensor": ("A tool wrote to a drive or sensor over SDO.",
                                          "While the device runs only the controller may. Restart the nodes, then reset."),
    "the left latch's report does not change": (
        "The left latch told the same in three releases: its contact or its wire is broken, or the latch is stuck.",
        "Keep the spring unloaded. Move the left latch by hand, and see whether its report here changes; mend it, then reset."),
    "the right latch's report does not change": (
        "The right latch told the same in three releases: its contact or its wire is broken, or the latch is stuck.",
        "Keep the spring unloaded. Move the right latch by hand, and see whether its report here changes; mend it, then reset."),
    "sensors or latches misplaced": (
        "A sensor or a latch sits on the wrong leg or the wrong way round, or an ankle's sensor is stuck.",
        "Look at object 0x2001:9 (afo ctl get misplaced): it tells which. Exchange or turn the part, reset, and walk anew."),
    "a drive's setting has changed": ("A drive's setting is not what it was at the set-up.",
                                      "The drive may have restarted. Switch drive and controller off and on."),
}
STATES = {
    "waiting for the nodes": "Not all drives and sensors are there yet, or one has a fault.",
    "self test": "Are the values fresh, and the springs slack?",
    "standby": "All is well, the torque is off. Walk asks it to engage.",
    "engaging": "The drives are enabled; the steps are not yet verified.",
    "walking": "It assists.",
    "unloading": "The springs are being unloaded; then the torque goes off.",
    "FAULT": "A fault is latched, the torque is off. Reset at standstill.",
    "commissioning": "A tool moves the motors a little.",
}
# CiA 301 table of emergency error codes, by classes; CiA 402 and our own codes in full.
EMERGENCIES = (
    (0xFF10, 0xFFFF, "the controller latched a fault"),
    (0x6320, 0xFFFF, "a node's parameters are not as expected"),
    (0x6100, 0xFFFF, "internal software: settings not read after crashes"),
    (0x8110, 0xFFFF, "CAN overrun: frames were lost"), (0x8120, 0xFFFF, "CAN error passive"),
    (0x8130, 0xFFFF, "heartbeat of another node missing"), (0x8140, 0xFFFF, "recovered from bus-off"),
    (0x8210, 0xFFFF, "a PDO was too short"), (0x8220, 0xFFFF, "a PDO was too long"),
    (0x8250, 0xFFFF, "an expected PDO did not come"),
    (0x8611, 0xFFFF, "following error: the motor does not keep up"),
    (0x3210, 0xFFFF, "supply voltage too high"), (0x3220, 0xFFFF, "supply voltage too low"),
    (0x4210, 0xFFFF, "too hot"), (0x4310, 0xFFFF, "drive too hot"), (0x2310, 0xFFFF, "over-current"),
    (0x7305, 0xFFFF, "incremental encoder 1"), (0x7320, 0xFFFF, "position sensor"),
    (0x0000, 0xFF00, "error reset: no error left"), (0x1000, 0xFF00, "generic error"), (0x2000, 0xF000, "current"),
    (0x3000, 0xF000, "voltage"), (0x4000, 0xF000, "temperature"), (0x5000, 0xFF00, "device hardware"),
    (0x6000, 0xF000, "device software"), (0x7000, 0xFF00, "additional modules"), (0x8000, 0xFF00, "monitoring"),
    (0x8100, 0xFF00, "communication"), (0x8200, 0xFF00, "protocol error"), (0x8600, 0xFF00, "positioning"),
    (0x9000, 0xFF00, "external error"),
    (0xF000, 0xFF00, "additional functions"), (0xFF00, 0xFF00, "device specific"))
NODES = {0x81: "left drive", 0x82: "right drive", 0x83: "left leg sensor", 0x84: "right leg sensor", 0x90: "controller"}


def fault(name):
    """{name, what, todo} of a fault by the controller's name of it."""
    what, todo = FAULTS.get(name, ("The controller reports a fault that this page does not know.",
                                   "Is the firmware newer than this program?"))
    return {"name": name, "what": what, "todo": todo}


def emergency(identifier, data):
    """An EMCY frame in words."""
    code = int.from_bytes(data[:2], "little")
    text = next((words for value, mask, words in EMERGENCIES if code & mask == value), "unknown error code")
    node = NODES.get(identifier, f"node {identifier - 0x80}")
    return {"node": node, "code": code, "text": f"{node}: {text} (0x{code:04X})", "over": code < 0x100}
