"""`afo g474 --gdb`: what gdb needs of a board, spoken by a debugger of our own, and by gdb where it is."""
import json
import pathlib
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "system"))
from gdb_peer import Debugger  # noqa: E402

ELF = ROOT / "build/arm/afo-nucleo-g474re.elf"
ENGINE = list((ROOT / "build" / "venv").glob("lib/python3*/site-packages/unicorn/lib/libunicorn.so.2"))
SP, LR, PC, XPSR = 13, 14, 15, 16
GPIOA_MODER, DBGMCU_IDCODE = 0x48000000, 0xE0042000

pytestmark = pytest.mark.skipif(not ENGINE, reason="the Unicorn engine is not in build/venv (scripts/setup test)")


def symbol(name):
    table = subprocess.run(["arm-none-eabi-nm", str(ELF)], capture_output=True, text=True, check=True).stdout
    return int(re.search(rf"^([0-9a-f]+) \w {name}$", table, re.MULTILINE).group(1), 16)


@pytest.fixture(name="run")
def a_run():
    process = subprocess.Popen([str(ROOT / "build/afo"), "g474", "--json", "--steps", "1", "--speed", "0.45", "--gdb", "0"], cwd=ROOT,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    port = int(re.search(r"target remote 127\.0\.0\.1:(\d+)", process.stderr.readline()).group(1))
    yield process, port
    process.kill()
    process.communicate()


@pytest.fixture(name="debugger")
def a_debugger(run):
    debugger = Debugger(run[1])
    yield debugger
    debugger.close()


def end_of(process):
    out, err = process.communicate(timeout=300)
    assert process.returncode == 0, out + err
    return json.loads(out)


def test_it_halts_at_the_reset_vector_and_shows_registers_and_memory(debugger):
    image = (ROOT / "build/arm/afo-nucleo-g474re.bin").read_bytes()
    stack, start = struct.unpack_from("<2I", image)
    assert "qXfer:features:read+" in debugger.ask("qSupported:multiprocess+")
    assert debugger.ask("?") == "S05"
    assert (debugger.register(SP), debugger.register(PC)) == (stack, start & ~1)
    assert bytes.fromhex(debugger.ask("m8002200,20")) == image[0x2200:0x2220]
    everything = bytes.fromhex(debugger.ask("g"))
    assert struct.unpack_from("<I", everything, 4 * PC)[0] == start & ~1 and len(everything) == 4 * 23 + 8 * 16 + 4
    assert debugger.ask("m10,4") == "E0e", "nothing is there"
    assert debugger.word(DBGMCU_IDCODE) & 0xFFF == 0x469, "RM0440: category 3 devices"


def test_the_description_is_what_gdb_asks_of_a_cortex_m(debugger):
    text, offset = "", 0
    while True:
        part = debugger.ask(f"qXfer:features:read:target.xml:{offset:x},100")
        text, offset = text + part[1:], offset + len(part) - 1
        if part[0] == "l":
            break
    target = ElementTree.fromstring(text.replace('<!DOCTYPE target SYSTEM "gdb-target.dtd">', ""))
    names = [register.get("name") for register in target.iter("reg")]
    assert target.findtext("architecture") == "arm"
    assert names[:17] == [f"r{i}" for i in range(13)] + ["sp", "lr", "pc", "xpsr"]
    assert names[17:23] == ["msp", "psp", "primask", "basepri", "faultmask", "control"]
    assert names[23:] == [f"d{i}" for i in range(16)] + ["fpscr"]


def test_registers_and_memory_are_written(debugger):
    assert debugger.ask("P5=78563412") == "OK" and debugger.register(5) == 0x12345678
    assert debugger.ask(f"P{23 + 9:x}=0102030405060708") == "OK"
    assert debugger.ask(f"p{23 + 9:x}") == "0102030405060708"
    assert debugger.ask("M20001000,4:efbeadde") == "OK" and debugger.word(0x20001000) == 0xDEADBEEF
    assert debugger.ask("M8000000,4:00000000") == "E0e", "flash"
    assert debugger.ask("P5=12") == "E01" and debugger.ask("pff") == "E01" and debugger.ask("vMustReplyEmpty") == ""


def test_breakpoints_steps_and_going_on(run, debugger):
    main = symbol("main")
    assert debugger.ask(f"Z1,{main:x},2") == "OK"
    assert debugger.ask("c") == "S05"
    assert debugger.register(PC) == main
    assert debugger.word(GPIOA_MODER) == 0, "its clock is off"
    seen = [main]
    for _ in range(20):
        assert debugger.ask("s") == "S05"
        seen.append(debugger.register(PC))
    assert 2 <= seen[1] - seen[0] <= 4 and len(set(seen)) > 10
    take = symbol("tim2_handler")
    assert debugger.ask(f"z1,{main:x},2") == "OK" and debugger.ask(f"Z0,{take:x},2") == "OK"
    for _ in range(2):
        assert debugger.ask("c") == "S05"
        assert debugger.register(PC) == take and debugger.register(XPSR) & 0x1FF == 16 + 28
        assert debugger.register(LR) >> 24 == 0xFF, "EXC_RETURN"
    assert debugger.word(GPIOA_MODER) >> 22 & 0xF == 0b1010, "PA11 and PA12 are FDCAN1's"
    assert debugger.ask("D") == "OK"
    end = end_of(run[0])
    assert end["steps"] >= 1 and end["findings"] == 0 and end["differences"] == 0


def test_it_can_be_interrupted_and_tells_the_end(run, debugger):
    debugger.send("c")
    debugger.interrupt()
    assert debugger.receive() == "S05"
    assert 0x08000000 <= debugger.register(PC) < 0x08040000
    assert debugger.ask("c") == "W00"
    assert end_of(run[0])["steps"] >= 1


def test_a_debugger_that_dies_leaves_the_walk_as_it_was(run):
    debugger = Debugger(run[1])
    assert debugger.ask(f"Z1,{symbol('tim2_handler'):x},2") == "OK"
    debugger.close()
    assert end_of(run[0])["steps"] >= 1


def test_rubbish_is_answered_or_asked_for_again(debugger):
    debugger.socket.sendall(b"\x00\xff++--$g#00")
    assert debugger.byte() == b"-", "a wrong sum"
    for packet in ("m", "m20000000", "m20000000,fffff", "M20000000,4:zz", "Z9,0,0", "z", "P", "p", "qXfer:features:read:x:0,1", ""):
        assert debugger.ask(packet) in ("", "E00", "E01", "E0e")
    assert debugger.ask("?") == "S05"


def test_what_is_wrong_is_told():
    def says(*options):
        result = subprocess.run([str(ROOT / "build/afo"), "g474", *options], cwd=ROOT, capture_output=True, text=True, timeout=60)
        assert result.returncode == 2
        return result.stderr

    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        assert f"127.0.0.1:{port}" in says("--gdb", str(port)) and "in use" in says("--gdb", str(port))
    assert "--gdb" in says("--gdb", "70000") and "--every" in says("--gdb", "0", "--every", "3", "--fault", "save-cut")


def test_it_listens_on_the_loopback_only(run):
    port = f":{run[1]:04X}"
    lines = [line.split()[1] for line in pathlib.Path("/proc/net/tcp").read_text().splitlines() if port in line.split()[1]]
    assert lines == [f"0100007F{port}"]


def test_ctrl_c_ends_it_while_it_waits(run):
    run[0].send_signal(signal.SIGINT)
    assert run[0].wait(timeout=30) != 0


@pytest.mark.skipif(shutil.which("gdb-multiarch") is None, reason="gdb-multiarch is not here (scripts/setup test)")
def test_gdb_itself_attaches(run):
    commands = [f"target remote 127.0.0.1:{run[1]}", "break main", "continue", "info registers pc", "stepi", "print $control", "print $d0",
                "x/2wx 0x08002000", "detach"]
    result = subprocess.run(["gdb-multiarch", "-batch", "-nx", str(ELF), *(part for command in commands for part in ("-ex", command))],
                            cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert "Breakpoint 1, main" in result.stdout and "<main>" in result.stdout, result.stdout + result.stderr
    assert end_of(run[0])["steps"] >= 1
