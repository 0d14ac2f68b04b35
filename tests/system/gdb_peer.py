"""A debugger's side of gdb's remote serial protocol, after the GDB manual ("Remote Protocol")."""
import socket


class Debugger:
    def __init__(self, port, timeout=120):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout)
        self.buffer = b""

    def byte(self):
        if not self.buffer:
            self.buffer = self.socket.recv(65536)
            if not self.buffer:
                raise EOFError
        byte, self.buffer = self.buffer[:1], self.buffer[1:]
        return byte

    def send(self, text):
        data = text.encode("ascii")
        self.socket.sendall(b"$%s#%02x" % (data, sum(data) & 0xFF))
        assert self.byte() == b"+"

    def receive(self):
        while self.byte() != b"$":
            pass
        data = b""
        while (byte := self.byte()) != b"#":
            data += byte
        assert int(self.byte() + self.byte(), 16) == sum(data) & 0xFF
        self.socket.sendall(b"+")
        return data.decode("ascii")

    def ask(self, text):
        self.send(text)
        return self.receive()

    def word(self, address):
        return int.from_bytes(bytes.fromhex(self.ask(f"m{address:x},4")), "little")

    def register(self, number):
        return int.from_bytes(bytes.fromhex(self.ask(f"p{number:x}")), "little")

    def interrupt(self):
        self.socket.sendall(b"\x03")

    def close(self):
        self.socket.close()
