"""What the page asks for, over HTTP and a websocket on 127.0.0.1. Who has not the token, or comes from a page of
another origin, gets nothing."""
import asyncio
import hmac
import json
import math
import pathlib
import tempfile
from typing import Any, Awaitable, Callable

from aiohttp import WSMsgType, web

from ..capture import Capture
from ..dictionary import FOLDER
from ..errors import Refused, SteadystepError
from .operation import Operation

PAGE = pathlib.Path(__file__).resolve().parent
HEADERS = {
    "Content-Security-Policy": "default-src 'self'; connect-src 'self' ws://127.0.0.1:* ws://localhost:*; style-src 'self' 'unsafe-inline'; "
                               "img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cache-Control": "no-store",
}
TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".json": "application/json"}
MOST_BYTES = 1 << 20
KEPT_CAPTURES = 8

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


def plain(value: Any) -> Any:
    """Without what JSON has no word for."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: plain(one) for key, one in value.items()}
    return [plain(one) for one in value] if isinstance(value, (list, tuple)) else value


def answer(value: Any, status: int = 200) -> web.Response:
    return web.json_response(plain(value), status=status)


class Web:
    """The handlers of an application."""

    def __init__(self, operation: Operation, token: str) -> None:
        self.operation, self._token = operation, token
        self._captured: dict[int, Capture] = {}  # the last ones, by number: each page shows its own
        self._captures = 0
        self.application = web.Application(middlewares=[self._guard], client_max_size=MOST_BYTES)
        self.application.on_response_prepare.append(self._put_headers)
        routes = self.application.router
        routes.add_get("/", self._index)
        routes.add_get("/static/{name}", self._file)
        routes.add_get("/api/dictionary", self._dictionary)
        routes.add_get("/api/live", self._live)
        routes.add_post("/api/live", self._choose)
        routes.add_post("/api/act/{action}", self._act)
        routes.add_get("/api/settings", self._settings)
        routes.add_post("/api/settings", self._set)
        routes.add_get("/api/settings.toml", self._export)
        routes.add_post("/api/settings.toml", self._import)
        routes.add_post("/api/capture", self._capture)
        routes.add_get(r"/api/capture/{number:\d{1,9}}.{suffix:\w+}", self._captured_file)
        routes.add_post("/api/knob", self._knob)

    async def _put_headers(self, _: web.Request, response: web.StreamResponse) -> None:
        response.headers.update(HEADERS)

    def _is_allowed(self, request: web.Request) -> bool:
        given = request.headers.get("Authorization", "").removeprefix("Bearer ") or request.query.get("token", "")
        return hmac.compare_digest(given.encode(), self._token.encode())

    @web.middleware
    async def _guard(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        """Another name for this address, another origin, no token; then errors in words."""
        transport = request.transport
        port = transport.get_extra_info("sockname")[1] if transport else 0
        hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}
        origin = request.headers.get("Origin")
        if request.host not in hosts or (origin is not None and origin not in {f"http://{host}" for host in hosts}):
            return answer({"error": "this page is served to its own origin only"}, 403)
        if request.path.startswith("/api/") and not self._is_allowed(request):
            return answer({"error": "the token is missing or wrong: open the address that `steadystep page` has "
                                    "printed"}, 401)
        try:
            return await handler(request)
        except SteadystepError as error:
            return answer({"error": str(error)}, 409)
        except (ValueError, TypeError, KeyError, OverflowError, RecursionError) as error:
            return answer({"error": f"expected another body: {error}"}, 400)

    async def _index(self, request: web.Request) -> web.StreamResponse:
        del request
        return self._send(PAGE / "static" / "index.html")

    async def _file(self, request: web.Request) -> web.StreamResponse:
        name = request.match_info["name"]
        for folder in (PAGE / "static", PAGE / "vendor"):
            if name in {path.name for path in folder.glob("*")}:
                return self._send(folder / name)
        raise web.HTTPNotFound()

    def _send(self, path: pathlib.Path) -> web.Response:
        return web.Response(body=path.read_bytes(), content_type=TYPES.get(path.suffix, "text/plain"), charset="utf-8")

    async def _dictionary(self, request: web.Request) -> web.StreamResponse:
        del request
        return self._send(FOLDER / "dictionary.json")

    # ---- live ----

    async def _live(self, request: web.Request) -> web.StreamResponse:
        if "Origin" not in request.headers:
            return answer({"error": "expected an Origin"}, 403)
        loop, queue = asyncio.get_running_loop(), asyncio.Queue[dict[str, Any]](50)

        def put(message: dict[str, Any]) -> None:
            if not queue.full():
                queue.put_nowait(message)

        def listener(message: dict[str, Any]) -> None:
            loop.call_soon_threadsafe(put, message)

        socket = web.WebSocketResponse(heartbeat=5)
        await socket.prepare(request)
        self.operation.listeners.append(listener)
        sender = asyncio.create_task(self._feed(socket, queue))
        try:
            async for message in socket:
                if message.type is WSMsgType.ERROR:
                    break
        finally:
            sender.cancel()
            self.operation.listeners.remove(listener)
        return socket

    async def _feed(self, socket: web.WebSocketResponse, queue: "asyncio.Queue[dict[str, Any]]") -> None:
        while not socket.closed:
            await socket.send_str(json.dumps(plain(await queue.get())))

    async def _choose(self, request: web.Request) -> web.StreamResponse:
        self.operation.show(_words((await _body(request))["signals"]))
        return answer({})

    # ---- actions ----

    async def _act(self, request: web.Request) -> web.StreamResponse:
        values = await _body(request) if request.can_read_body else {}
        await asyncio.to_thread(self.operation.act, request.match_info["action"], values)
        return answer({})

    async def _knob(self, request: web.Request) -> web.StreamResponse:
        line = str((await _body(request))["line"])
        return answer({"said": await asyncio.to_thread(self.operation.turn_knob, line)})

    # ---- settings ----

    async def _settings(self, request: web.Request) -> web.StreamResponse:
        del request
        return answer(await asyncio.to_thread(lambda: self.operation.drive.settings.all()))

    async def _set(self, request: web.Request) -> web.StreamResponse:
        """{"name": …, "value": …}, null is not given; or {"name": …, "default": true}. All of them come back, as one may
        move others."""
        body = await _body(request)
        name, is_default = str(body["name"]), body.get("default") is True
        value = None if is_default else _given(body["value"])

        def put() -> dict[str, Any]:
            settings = self.operation.drive.settings
            if value is None:
                settings.default(name)
            else:
                settings[name] = value
            return dict(settings.all())

        return answer(await asyncio.to_thread(put))

    async def _export(self, request: web.Request) -> web.StreamResponse:
        del request
        return web.Response(text=await asyncio.to_thread(lambda: self.operation.drive.settings.export()))

    async def _import(self, request: web.Request) -> web.StreamResponse:
        text = await request.text()
        return answer(await asyncio.to_thread(lambda: self.operation.drive.settings.load(text, "the file")))

    # ---- captures ----

    async def _capture(self, request: web.Request) -> web.StreamResponse:
        body = await _body(request)
        move = None if body.get("move") is None else dict(body["move"])
        made, refused = await asyncio.to_thread(self.operation.capture, _words(body["signals"]),
                                                float(body["duration_s"]), float(body["rate_Hz"]), move)
        self._captures += 1
        self._captured[self._captures] = made
        self._captured.pop(self._captures - KEPT_CAPTURES, None)
        return answer({"number": self._captures, "time_s": made.time_s, "columns": made.columns, "rate_Hz": made.rate_Hz,
                       "move_refused": refused})

    async def _captured_file(self, request: web.Request) -> web.StreamResponse:
        captured = self._captured.get(int(request.match_info["number"]))
        if captured is None:
            raise Refused(f"that capture is not kept any more; the last {KEPT_CAPTURES} are")
        with tempfile.TemporaryDirectory() as scratch:
            path = pathlib.Path(scratch) / f"capture.{request.match_info['suffix']}"
            await asyncio.to_thread(captured.save, path)
            return web.Response(body=path.read_bytes(), content_type="application/octet-stream")


async def _body(request: web.Request) -> dict[str, Any]:
    body = await request.json()
    if not isinstance(body, dict):
        raise TypeError("it is no object")
    return body


def _given(value: Any) -> Any:
    """JSON has no NaN, which is "not given"."""
    if isinstance(value, list):
        return [_given(one) for one in value]
    return math.nan if value is None else value


def _words(value: Any) -> list[str]:
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
        raise Refused("expected a list of signals")
    return value
