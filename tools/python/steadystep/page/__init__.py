"""The page: a drive in the browser, on loopback."""
import argparse
import asyncio
import secrets
import signal
import webbrowser

from aiohttp import web

from ..cli_words import command_name
from ..errors import SteadystepError, WrongPort
from ..simulator import Knobs, Simulated
from .operation import Operation
from .handlers import PAGE, Web


async def _serve(operation: Operation, arguments: argparse.Namespace) -> None:
    token = secrets.token_urlsafe(24)
    runner = web.AppRunner(Web(operation, token).application, access_log=None,
                           shutdown_timeout=1)  # a page that is open is not waited for
    await runner.setup()
    try:
        await web.TCPSite(runner, "127.0.0.1", arguments.http).start()
    except OSError as error:
        raise WrongPort(f"127.0.0.1:{arguments.http}: {error.strerror}") from None
    address = f"http://127.0.0.1:{runner.addresses[0][1]}/#{token}"
    shared = [*([arguments.link] if arguments.link else []), f"tcp://127.0.0.1:{operation.tcp_port}"]
    print(f"page: {address}\nanother program: {command_name()} --port {shared[0]} move 1.5 --enable", flush=True)
    if arguments.open:
        webbrowser.open(address)
    ended = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, ended.set)
    try:
        await ended.wait()
    finally:
        await runner.cleanup()


def serve(arguments: argparse.Namespace) -> int:
    """Until it is interrupted."""
    if not (PAGE / "vendor" / "uPlot.iife.min.js").exists():
        raise SteadystepError("uPlot is missing, which draws the traces: tools/setup page fetches it into the source tree, "
                              "from where pip install takes it along")
    simulated = Simulated(motor=arguments.motor, program=arguments.simulator) if arguments.simulate else None
    operation = None
    try:
        knobs = simulated.knobs if simulated else _knobs(arguments.knobs)
        operation = Operation(simulated.place if simulated else arguments.port, knobs, arguments.link, arguments.tcp)
        asyncio.run(_serve(operation, arguments))
    finally:
        if operation:
            operation.close()
        if simulated:
            simulated.close()
    return 0


def _knobs(place: str | None) -> Knobs | None:
    return Knobs(place) if place else None
