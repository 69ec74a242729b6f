"""The page: a drive in the browser, on loopback."""
import argparse

from ..errors import SteadystepError


def serve(arguments: argparse.Namespace) -> int:
    raise SteadystepError("the page is not there yet")
