"""Where the processor looks for its vectors once the flashed image runs, whatever it found at reset.

The image runs up to main on QEMU's STM32F405 (same core, flash and RAM at the same addresses), which
leaves VTOR at 0 as a loader might leave it anywhere.
"""
import pathlib
import shutil
import socket
import subprocess
import time

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
IMAGE = ROOT / "build/arm/afo-nucleo-g474re.elf"
VTOR = 0xE000ED08  # Armv7-M Architecture Reference Manual, B3.2.5


def address_of(name):
    text = subprocess.run(["arm-none-eabi-nm", str(IMAGE)], capture_output=True, text=True, check=True).stdout
    return next(int(line.split()[0], 16) for line in text.splitlines() if line.split()[-1] == name)


def ask(connection, command):
    """One command of the GDB remote serial protocol; returns its answer."""
    connection.sendall(f"${command}#{sum(command.encode()) & 0xFF:02x}".encode())
    answer = b""
    while not (b"$" in answer and b"#" in answer[answer.index(b"$"):-2]):
        answer += connection.recv(4096)
    connection.sendall(b"+")
    return answer[answer.index(b"$") + 1:answer.rindex(b"#")].decode()


@pytest.mark.skipif(shutil.which("qemu-system-arm") is None, reason="no qemu-system-arm")
def test_the_vector_table_is_the_image_s(tmp_path):
    assert IMAGE.exists(), "make firmware"
    path = str(tmp_path / "gdb")
    with subprocess.Popen(["qemu-system-arm", "-M", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "none",
                           "-S", "-chardev", f"socket,path={path},server=on,wait=off,id=gdb", "-gdb", "chardev:gdb",
                           "-kernel", str(IMAGE)]) as qemu:
        try:
            connection = socket.socket(socket.AF_UNIX)
            connection.settimeout(20)
            for _ in range(100):
                if pathlib.Path(path).exists():
                    break
                time.sleep(0.05)
            connection.connect(path)
            assert ask(connection, f"m{VTOR:x},4") == "00000000"
            assert ask(connection, f"Z0,{address_of('main'):x},2") == "OK"
            assert ask(connection, "c").startswith("T05")
            found = int.from_bytes(bytes.fromhex(ask(connection, f"m{VTOR:x},4")), "little")
            assert found == address_of("vector_table") == 0x08002000  # behind the starter, which has run
        finally:
            qemu.kill()
