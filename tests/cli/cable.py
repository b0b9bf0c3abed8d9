"""cable.py: a cable between a host and a virtual indenter that can be pulled: cable.py PTY SOCKET LOG [rest]
Listens at SOCKET and passes bytes to and from PTY. With "rest" it is pulled once, as soon as the host has ordered the samples off (a rest
between runs); else by SIGUSR1, and is in again after SIGUSR2. What comes from the indenter while it is out is lost. LOG says what happened."""
import os
import select
import signal
import socket
import sys
import tty

STREAM = 3  # the command's type


class Cable:
    def __init__(self, pty, path, log, at_rest):
        self.device = os.open(pty, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.device)
        self.path, self.log, self.at_rest = path, open(log, "w", buffering=1), at_rest
        self.listener = self.host = None
        self.frame = b""
        self.wake, wake = os.pipe()
        os.set_blocking(wake, False)
        signal.set_wakeup_fd(wake)
        for number in (signal.SIGUSR1, signal.SIGUSR2):
            signal.signal(number, lambda *_: None)
        self.plug_in()

    def plug_in(self):
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(self.path)
        self.listener.listen()
        self.log.write("in\n")

    def pull(self):
        for end in (self.listener, self.host):
            if end:
                end.close()
        self.listener = self.host = None
        os.unlink(self.path)
        self.log.write("out\n")

    def orders_rest(self, data):
        """Whether a command in it turns the samples off."""
        found = False
        for byte in data:
            if byte:
                self.frame += bytes([byte])
                continue
            body, at = self.frame[:-3], 0
            payload = b""
            while at < len(body):
                payload += body[at + 1:at + body[at]] + b"\0"
                at += body[at]
            found |= len(payload) > 7 and payload[0] == STREAM and payload[7] == 0
            self.frame = b""
        return found

    def from_host(self):
        try:
            data = self.host.recv(4096)
        except ConnectionError:
            data = b""
        if not data:
            self.host.close()
            self.host = None
            return
        os.write(self.device, data)
        if self.at_rest and self.orders_rest(data):
            self.at_rest = False
            self.pull()
            self.plug_in()

    def from_device(self):
        data = os.read(self.device, 65536)
        try:
            if self.host:
                self.host.sendall(data)
        except ConnectionError:
            self.host.close()
            self.host = None

    def signalled(self):
        for number in os.read(self.wake, 64):
            if number == signal.SIGUSR1 and self.listener:
                self.pull()
            elif number == signal.SIGUSR2 and not self.listener:
                self.plug_in()

    def run(self):
        while True:
            ready, _, _ = select.select([x for x in (self.wake, self.device, self.listener, self.host) if x is not None], [], [])
            if self.wake in ready:
                self.signalled()
                continue
            if self.listener in ready:
                self.host = self.listener.accept()[0]
                continue
            if self.device in ready:
                self.from_device()
            if self.host and self.host in ready:
                self.from_host()


try:
    Cable(*sys.argv[1:4], len(sys.argv) > 4).run()
except OSError:
    pass  # the indenter has ended
