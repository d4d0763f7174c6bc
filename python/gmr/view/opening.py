"""viser, where it is installed, and a server of it that keeps to this machine."""

from __future__ import annotations

import contextlib
import io
from typing import TYPE_CHECKING

from gmr.errors import GmrError, MissingExtraError

if TYPE_CHECKING:
    from viser import ViserServer

__all__ = ["HOST", "closed", "opened"]

HOST = "127.0.0.1"
_FIRST_PORT = 8080


def opened(port: int | None = None) -> ViserServer:
    """A server that this machine alone can reach.

    Args:
        port: None: the first free one from 8080 on; 0: any free one.

    Raises:
        MissingExtraError: viser is not installed (the extra ``view``).
        GmrError: the port is taken.
    """
    try:
        from viser import ViserServer
    except ImportError as error:
        raise MissingExtraError("viser", "view", "Showing motions") from error
    with contextlib.redirect_stdout(io.StringIO()):  # its greeting
        server = ViserServer(host=HOST, port=_FIRST_PORT if port is None else port, verbose=False)
    if port and server.get_port() != port:
        closed(server)
        raise GmrError(f"port {port} is taken; give another, or none for the first that is free")
    server.scene.set_up_direction("+y")
    return server


def closed(server: ViserServer) -> None:
    """Stops a server."""
    with contextlib.redirect_stdout(io.StringIO()):  # its farewell
        server.stop()
