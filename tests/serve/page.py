"""The page of a drive, by what it asks its server for: who is let in, what its buttons do, what it shows.

usage: page.py SIL
"""
import asyncio
import contextlib
import os
import pathlib
import socket
import threading
import time

from operated import Simulated, refusal, steadystep
from page_process import SIL, Page
from served import Checks
from steadystep.page.operation import Operation
from steadystep.simulator import Knobs

import aiohttp

CHECKS = Checks()


class Client:
    """What page.js does."""

    def __init__(self, page, session):
        self.page, self.session = page, session

    async def ask(self, method, path, body=None, **headers):
        """Status and answer."""
        headers = {"Authorization": f"Bearer {self.page.token}", **headers}
        if isinstance(body, str):
            given = {"data": body}
        else:
            given = {"json": body} if body is not None else {}
        async with self.session.request(method, self.page.url + path, headers=headers, **given) as said:
            is_json = said.content_type == "application/json"
            return said.status, await said.json() if is_json else await said.text()

    async def bytes_of(self, path):
        async with self.session.get(self.page.url + path, headers={"Authorization": f"Bearer {self.page.token}"}) as said:
            return await said.read()

    async def act(self, action, **values):
        status, said = await self.ask("POST", f"/api/act/{action}", values)
        CHECKS.that(status == 200, f"{action}: {status} {said}")

    def live(self, origin=None, token=None):
        headers = {"Origin": self.page.url if origin is None else origin} if origin != "" else {}
        return self.session.ws_connect(f"{self.page.url}/api/live?token={token or self.page.token}", headers=headers)

    async def status(self, condition=lambda status: True, timeout_s=10.0):
        """The first that fulfils it; the last one if none comes in time."""
        last = {}
        async with self.live() as live:
            end = time.monotonic() + timeout_s
            while time.monotonic() < end and not (last and condition(last)):
                with contextlib.suppress(asyncio.TimeoutError):
                    last = (await live.receive_json(timeout=1)).get("status", last)
        return last


async def who_is_let_in(client):
    url = client.page.url
    for path in ("/", "/static/page.js", "/static/uPlot.iife.min.js"):
        status, _ = await client.ask("GET", path, Authorization="")
        CHECKS.that(status == 200, f"{path} holds no secret: {status}")
    for path in ("/static/../__init__.py", "/static/..%2f__init__.py", "/static/web.py"):
        status, said = await client.ask("GET", path)
        CHECKS.that(status == 404, f"{path}: {status} {said}")
    for headers, expected in (({"Authorization": ""}, 401), ({"Authorization": "Bearer wrong"}, 401),
                              ({"Origin": "http://elsewhere.example"}, 403), ({"Origin": "null"}, 403),
                              ({"Host": "elsewhere.example"}, 403), ({"Origin": url}, 200)):
        for method, path, body in (("GET", "/api/settings", None), ("POST", "/api/act/stop", {})):
            status, said = await client.ask(method, path, body, **headers)
            CHECKS.that(status == expected, f"{method} {path} with {headers}: {status} {said}")
    for origin, token, expected in (("http://elsewhere.example", None, 403), ("", None, 403), (None, "wrong", 401)):
        try:
            async with client.live(origin, token):
                CHECKS.that(False, f"a socket of {origin} {token} is refused")
        except aiohttp.WSServerHandshakeError as refusal:
            CHECKS.that(refusal.status == expected, f"a socket of {origin} {token}: {refusal.status}")


def nothing_listens_beyond_loopback(page):
    sockets = {os.readlink(link) for link in pathlib.Path(f"/proc/{page.process.pid}/fd").iterdir()
               if link.is_symlink() and os.path.lexists(link)}
    inodes = {name[8:-1] for name in sockets if name.startswith("socket:")}
    listening = []
    for table in ("tcp", "tcp6"):
        rows = [line.split() for line in pathlib.Path(f"/proc/net/{table}").read_text().splitlines()[1:]]
        listening += [row[1] for row in rows if row[3] == "0A" and row[9] in inodes]
    CHECKS.that(len(listening) == 2 and all(one.startswith("0100007F:") for one in listening), f"{listening}")


async def it_is_operated(client):
    await client.act("enable")
    await client.act("move", position_rad=1.5)
    found = await client.status(lambda now: abs(now.get("position_rad", 0) - 1.5) < 0.01)
    CHECKS.that(found["state"] == "OPERATION ENABLED" and found["simulated"], f"it goes to 1.5: {found}")
    with steadystep.Drive(client.page.shared) as other:
        await asyncio.to_thread(other.move, 0.5)
    found = await client.status(lambda now: abs(now["position_rad"] - 0.5) < 0.01)
    CHECKS.that(abs(found["position_rad"] - 0.5) < 0.01, f"another program moves it meanwhile: {found}")
    for action, values, said in (("move", {"position_rad": "a"}, "position_rad: expected a number"),
                                 ("jump", {}, "jump: expected one of enable"),
                                 ("move", {"position_rad": 1e9}, "position_rad: expected a number in")):
        status, answer = await client.ask("POST", f"/api/act/{action}", values)
        CHECKS.that(status == 409 and said in answer["error"], f"{action} {values}: {status} {answer}")


async def it_is_homed(client):
    """On a stop, and where it stands; why not, in words."""
    _, said = await client.ask("POST", "/api/knob", {"line": "state"})
    stop = float(said["said"].split("theta_rad=")[1].split()[0]) + 0.5
    await client.ask("POST", "/api/knob", {"line": f"stops = true, stop_high_rad = {stop}"})
    homing = asyncio.create_task(client.act("home", method="stop-up", position_rad=2.0))
    found = await client.status(lambda now: now["doing"])
    CHECKS.that(found["doing"] == "homing", f"that it homes is shown: {found['doing']}")
    await homing
    found = await client.status(lambda now: now["reference"] == "referenced")
    off = found["position_rad"] - 2.0 - (float(found["truth"]["theta_rad"]) - stop)
    CHECKS.that(abs(off) < 0.01 and found["reference"] == "referenced", f"the stop is at 2 rad: {off}")
    await client.ask("POST", "/api/knob", {"line": "stops = false"})
    for values, said in (({"method": "index-up"}, "no encoder with an index"), ({"method": "up"}, "one of here, stop-down"),
                         ({"method": "stop-up", "travel_rad": 0.3}, "within its travel nothing bore"),
                         ({"method": "here", "position_rad": "a"}, "position_rad: expected a number")):
        status, answer = await client.ask("POST", "/api/act/home", {"position_rad": 0, **values})
        CHECKS.that(status == 409 and said in answer["error"], f"home {values}: {status} {answer}")
    homing = asyncio.create_task(client.ask("POST", "/api/act/home", {"method": "stop-up", "position_rad": 0, "travel_rad": 600}))
    await client.status(lambda now: now["moving"] and now["doing"] == "homing")
    await client.act("stop")
    status, answer = await homing
    CHECKS.that(status == 409 and answer["error"] == "stopped", f"a stop ends it: {status} {answer}")
    found = await client.status(lambda now: not now["moving"])
    CHECKS.that(found["state"] == "QUICK STOP ACTIVE" and not found["moving"], f"and the rotor is held: {found}")
    await client.act("enable")
    await client.act("home", method="here", position_rad=0.5)
    found = await client.status(lambda now: abs(now["position_rad"] - 0.5) < 0.01)
    CHECKS.that(abs(found["position_rad"] - 0.5) < 0.01, f"here is 0.5: {found}")


async def stop_works(client):
    await client.act("velocity", speed_rad_s=20)
    await client.status(lambda now: now["moving"])
    begin = time.monotonic()
    await client.act("stop")
    found = await client.status(lambda now: not now["moving"])
    CHECKS.that(found["state"] == "QUICK STOP ACTIVE" and not found["moving"], f"it stops: {found}")
    CHECKS.that(time.monotonic() - begin < 2, "soon")
    await client.act("disable")
    await client.status(lambda now: now["state"] == "SWITCH ON DISABLED")
    enabling = asyncio.create_task(client.ask("POST", "/api/act/enable", {}))
    await asyncio.sleep(0.15)
    await client.act("stop")
    status, said = await enabling
    found = await client.status(lambda now: now["state"] == "SWITCH ON DISABLED")
    CHECKS.that(found["state"] in ("SWITCH ON DISABLED", "QUICK STOP ACTIVE"), f"an enabling ends: {found} {said}")
    await client.act("disable")
    # what has been aligned in part swings for a while, and the drive wants a rotor at rest
    await client.status(lambda now: abs(float(now["truth"]["omega_rad_s"])) < 0.05)


async def stop_waits_for_nobody(client):
    """Another program is in the midst of a transfer, and does not go on."""
    await client.act("enable")
    await client.act("velocity", speed_rad_s=20)
    await client.status(lambda now: now["moving"])
    reader, writer = await asyncio.open_connection(*client.page.shared.removeprefix("tcp://").split(":"))
    writer.write(b"O\rt60184010230000000000\r")
    await reader.readuntil(b"t581841")
    stopping = asyncio.create_task(client.act("stop"))
    await asyncio.sleep(0.3)
    _, said = await client.ask("POST", "/api/knob", {"line": "state"})
    speed = float(said["said"].split("omega_rad_s=")[1].split()[0])
    CHECKS.that(abs(speed) < 2, f"it is at rest by then: {speed} rad/s")
    CHECKS.that(not stopping.done(), "while the transfer is still that program's")
    await stopping
    writer.close()
    found = await client.status(lambda now: now["state"] != "OPERATION ENABLED")
    CHECKS.that(found["state"] in ("QUICK STOP ACTIVE", "SWITCH ON DISABLED"), f"it stays so: {found}")
    await client.act("disable")


async def settings_go_round(client):
    _, before = await client.ask("GET", "/api/settings")
    status, after = await client.ask("POST", "/api/settings", {"name": "current_limit_A", "value": 2.5})
    CHECKS.that(status == 200 and after == {**before, "current_limit_A": 2.5}, f"one is set: {status}")
    _, text = await client.ask("GET", "/api/settings.toml")
    CHECKS.that("current_limit_A = 2.5  # A\n" in text, "and exported")
    await client.ask("POST", "/api/settings", {"name": "current_limit_A", "default": True})
    _, changed = await client.ask("POST", "/api/settings.toml", text)
    CHECKS.that(changed == ["current_limit_A"], f"and comes back: {changed}")
    for name, value, said in (("current_limit_A", 100, "0.01 × rated…2 × rated A"), ("law", 3, "one of"),
                              ("current_limit_A", None, "got nan"), ("current_limit_A", "2,5", "expected a number in 0.01"),
                              ("nothing", 1, "no such setting")):
        status, answer = await client.ask("POST", "/api/settings", {"name": name, "value": value})
        CHECKS.that(status == 409 and said in answer["error"], f"{name} = {value}: {status} {answer}")
    for path, body in (("settings", {"name": "law"}), ("settings", ["law"]), ("settings", "[" * 100000), ("act/move", []),
                       ("act/move", '{"position_rad": ' + 4000 * "9" + "}"), ("knob", "no JSON")):
        status, _ = await client.ask("POST", f"/api/{path}", body)
        CHECKS.that(status == 400, f"half a request, {path} {str(body)[:20]}: {status}")


async def traces_come(client):
    async with client.live() as live:
        messages = [await live.receive_json(timeout=5) for _ in range(20)]
        span_s = messages[-1]["time_s"] - messages[0]["time_s"]
        CHECKS.that(len(messages[0]["values"]) == 4 and span_s < 6, f"20 samples in {span_s:.2f} s")
        await client.ask("POST", "/api/live", {"signals": ["bus_V"]})
        seen = [await live.receive_json(timeout=5) for _ in range(4)][-1]
        CHECKS.that(seen["signals"] == ["bus_V"] and abs(seen["values"][0] - 24) < 1, f"of others: {seen}")
    async with client.live() as live:
        status, made = await client.ask("POST", "/api/capture", {"signals": ["bus_V", "i_q_A"], "duration_s": 0.3,
                                                                 "rate_Hz": 100})
        shown = [message.get("capturing") for message in [await live.receive_json(timeout=5) for _ in range(8)]]
    CHECKS.that(1.0 in shown, f"how far it is is shown: {shown}")
    CHECKS.that(status == 200 and len(made["columns"]["i_q_A"]) == len(made["time_s"]) > 5, f"captured: {made}")
    _, other = await client.ask("POST", "/api/capture", {"signals": ["period"], "duration_s": 0.01, "rate_Hz": 100})
    CHECKS.that(other["number"] != made["number"], "another page's is another one")
    for suffix, begin in (("csv", b"time_s,bus_V,i_q_A"), ("parquet", b"PAR1"), ("mcap", b"\x89MCAP")):
        saved = await client.bytes_of(f"/api/capture/{made['number']}.{suffix}")
        CHECKS.that(saved.startswith(begin), f"saved as .{suffix}: {saved[:60]}")
    for path, code in (("999.csv", 409), ("1.exe", 409), ("1.csv%2f..%2fx.csv", 404), ("x.csv", 404)):
        status, said = await client.ask("GET", f"/api/capture/{path}")
        CHECKS.that(status == code, f"{path}: {status} {said}")


async def a_capture_comes_with_its_move(client):
    """And no move without it."""
    body = {"signals": ["theta_est_rad", "reference_moving"], "duration_s": 1.0, "rate_Hz": 200,
            "move": {"position_rad": 0.2, "relative": True}}
    status, made = await client.ask("POST", "/api/capture", body)
    CHECKS.that(status == 200 and "enable it first" in made["move_refused"], f"a move that is refused: {status}")
    await client.act("enable")
    before = (await client.status())["position_rad"]
    status, said = await client.ask("POST", "/api/capture", {**body, "rate_Hz": 0})
    CHECKS.that(status == 409 and "a rate of up to" in said["error"], f"a capture that is refused: {said}")
    await asyncio.sleep(0.2)
    CHECKS.that(abs((await client.status())["position_rad"] - before) < 0.01, "moves nothing")
    status, made = await client.ask("POST", "/api/capture", body)
    moving = made["columns"]["reference_moving"]
    CHECKS.that(made["move_refused"] == "" and not moving[0] and any(moving), "the begin of the move is in it")


async def a_capture_hides_nothing(client):
    """What happens meanwhile is shown, another one waits, and it may be ended, by a stop or by itself."""
    body = {"signals": ["period"] * 9, "duration_s": 60, "rate_Hz": 100}  # more than the drive records by itself
    for ended_by, state in (("end-capture", "OPERATION ENABLED"), ("stop", "QUICK STOP ACTIVE")):
        await client.act("enable")
        await client.act("velocity", speed_rad_s=5)
        capturing = asyncio.create_task(client.ask("POST", "/api/capture", body))
        await client.status(lambda now: now["moving"])
        status, said = await client.ask("POST", "/api/capture", body)
        CHECKS.that(status == 409 and "a capture is under way" in said["error"], f"another one: {said}")
        await client.act(ended_by)
        status, said = await asyncio.wait_for(capturing, 5)
        CHECKS.that(status == 409 and "ended" in said["error"], f"{ended_by}: {status} {said}")
        found = await client.status(lambda now, state=state: now["state"] == state)
        CHECKS.that(found["state"] == state, f"{ended_by}: then it is {found['state']}")
    await client.act("enable")
    capturing = asyncio.create_task(client.ask("POST", "/api/capture", body))
    await asyncio.sleep(0.2)
    await client.ask("POST", "/api/knob", {"line": "plant.bus_V = 8"})
    found = await client.status(lambda now: now["fault"], 3)
    CHECKS.that(found["fault"] and not capturing.done(), f"a fault meanwhile: {found['state']}")
    await client.act("end-capture")
    await capturing
    await client.ask("POST", "/api/knob", {"line": "plant.bus_V = 24"})
    await client.act("reset")


def knobs_may_come_and_go():
    """The drive behind them is there all the same."""
    def answering(listener):
        connected = listener.accept()[0]
        with connected:
            while connected.recv(100):
                connected.sendall(b"ok theta_rad=1.5\n")

    def served(port):
        listener = socket.create_server(("127.0.0.1", port))
        threading.Thread(target=answering, args=(listener,), daemon=True).start()
        return listener

    with Simulated(program=SIL) as simulated:
        listener = served(0)
        port = listener.getsockname()[1]
        knobs = Knobs(f"tcp://127.0.0.1:{port}")
        operation = Operation(simulated.place, knobs, None, 0)
        status = operation._sample(True, True)["status"]
        CHECKS.that(status["truth"] == {"theta_rad": "1.5"}, f"the truth: {status}")
        listener.close()
        knobs._line._socket.shutdown(socket.SHUT_RDWR)
        status = operation._sample(True, True)["status"]
        CHECKS.that(status["lost"] == "" and status["truth"] is None, f"gone: {status}")
        served(port)
        CHECKS.that(refusal(lambda: knobs.turn("state")) == "" and knobs.truth() == {"theta_rad": "1.5"}, "and back again")
        CHECKS.that("a knob is one line" in refusal(lambda: knobs.turn(" ")), "an empty one is none")
        operation.close()
        knobs.close()


async def what_breaks_is_said(client):
    await client.act("enable")
    status, said = await client.ask("POST", "/api/knob", {"line": "plant.bus_V = 8"})
    CHECKS.that(status == 200 and said["said"].startswith("ok time_s="), f"a knob: {said}")
    found = await client.status(lambda now: now["fault"])
    CHECKS.that(found["fault"]["name"] == "bus-voltage" and found["fault"]["remedy"], f"the fault in words: {found}")
    status, said = await client.ask("POST", "/api/knob", {"line": "nothing = 1"})
    CHECKS.that(status == 409, f"a knob that is none: {said}")
    await client.ask("POST", "/api/knob", {"line": "plant.bus_V = 24"})
    await client.act("reset")
    await client.ask("POST", "/api/knob", {"line": 'command = "power-cycle"'})
    found = await client.status(lambda now: now["lost"])
    CHECKS.that(found["lost"], f"a lost link is said: {found}")
    found = await client.status(lambda now: not now["lost"])
    CHECKS.that(found.get("state") == "SWITCH ON DISABLED", f"and found again: {found}")


async def main(page):
    async with aiohttp.ClientSession() as session:
        client = Client(page, session)
        await who_is_let_in(client)
        await it_is_operated(client)
        await it_is_homed(client)
        await stop_works(client)
        await stop_waits_for_nobody(client)
        await settings_go_round(client)
        await traces_come(client)
        await a_capture_comes_with_its_move(client)
        await a_capture_hides_nothing(client)
        await what_breaks_is_said(client)


knobs_may_come_and_go()
PAGE = Page()
try:
    nothing_listens_beyond_loopback(PAGE)
    asyncio.run(main(PAGE))
finally:
    CODE, SAID = PAGE.end()
CHECKS.that(CODE == 0 and SAID == "", f"it ends in order: {CODE} {SAID}")
CHECKS.end()
