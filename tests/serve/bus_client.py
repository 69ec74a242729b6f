"""A client of the drive's link that is small and fast, and may be as rude as it likes: frames of slcan."""
import os
import select
import struct
import time

HEARTBEAT_S = 0.05
MASTER = 5  # the node whose heartbeat the client sends


class Lost(Exception):
    """No answer, in time."""


class Refused(Exception):
    """An abort, with its code."""

    def __init__(self, code):
        super().__init__(f"aborted: {code:08x}")
        self.code = code


class BusClient:
    """One node, number 1, on a served drive's terminal."""

    def __init__(self, place):
        self.file = os.open(place, os.O_RDWR | os.O_NOCTTY)
        self.rest, self.answers, self.emergencies = b"", [], []
        self.supervised, self.beaten = False, 0.0
        self.send(b"\rC\rS6\rO\r")
        self.pump(0.1)

    def close(self):
        """Without a word: a cable that is cut."""
        os.close(self.file)

    def send(self, data):
        os.write(self.file, data)

    def pump(self, seconds):
        """Reads for so long; sends heartbeats."""
        end = time.monotonic() + seconds
        while True:
            now = time.monotonic()
            if self.supervised and now - self.beaten > HEARTBEAT_S:
                self.beaten = now
                self.send(b"t705105\r")
            left = min(HEARTBEAT_S / 2, end - now)
            if left <= 0:
                return
            if select.select([self.file], [], [], left)[0]:
                self.take(os.read(self.file, 65536))
                return

    def take(self, data):
        *lines, self.rest = (self.rest + data).split(b"\r")
        for line in lines:
            line = line[line.rfind(b"t"):] if b"t" in line else b""
            try:
                number, data = int(line[1:4], 16), bytes.fromhex(line[5:].decode())
            except ValueError:
                continue
            if number == 0x581 and len(data) == 8:
                self.answers.append(data)
            elif number == 0x081 and len(data) == 8:
                self.emergencies.append(struct.unpack_from("<H", data)[0])

    def request(self, data):
        for _ in range(3):
            self.answers.clear()
            self.send(b"t6018" + data.hex().upper().encode() + b"\r")
            end = time.monotonic() + 2.0
            while time.monotonic() < end:
                self.pump(0.05)
                if self.answers:
                    return self.checked(self.answers.pop(0))
        raise Lost(f"no answer to {data.hex()}")

    @staticmethod
    def checked(answer):
        if answer[0] == 0x80:
            raise Refused(struct.unpack_from("<I", answer, 4)[0])
        return answer

    def read(self, index, sub=0):
        answer = self.request(struct.pack("<BHB4x", 0x40, index, sub))
        if answer[0] & 2:
            return answer[4:8 - (answer[0] >> 2 & 3)]
        length, data, toggle = struct.unpack_from("<I", answer, 4)[0], b"", 0
        while len(data) < length:
            data += self.request(bytes([0x60 | toggle]) + bytes(7))[1:]
            toggle ^= 0x10
        return data[:length]

    def write(self, index, sub, data):
        if len(data) <= 4:
            self.request(struct.pack("<BHB", 0x23 | (4 - len(data)) << 2, index, sub) + data.ljust(4, b"\0"))
            return
        self.request(struct.pack("<BHBI", 0x21, index, sub, len(data)))
        for begin in range(0, len(data), 7):
            piece = data[begin:begin + 7]
            last = begin + 7 >= len(data)
            self.request(bytes([begin // 7 % 2 << 4 | 7 - len(piece) << 1 | last]) + piece.ljust(7, b"\0"))

    def number(self, index, sub=0, form="<i"):
        return struct.unpack(form, self.read(index, sub))[0]

    def put(self, index, value, form="<i", sub=0):
        self.write(index, sub, struct.pack(form, value))

    def status(self):
        return self.number(0x6041, form="<H")

    def control(self, word):
        self.put(0x6040, word, "<H")
