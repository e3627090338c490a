"""The live page: served on this machine, made anew when its file changes."""

import sys
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Lock
from typing import Any

from parflex.base.errors import InputError
from parflex.views.viewer.opening import Opened, opened, showing
from parflex.views.viewer.page import page_of
from parflex.views.viewer.stress import with_stress

STAMP = "/stamp"


class LivePage:
    """The page of a file as the file is now."""

    def __init__(self, path: Path, curves: bool, modes: Path | None) -> None:
        self._path, self._curves, self._modes = path, curves, modes
        self._made: tuple[str, str] | None = None  # of which time stamp, and its text
        self._lock = Lock()
        self.text()

    def stamp(self) -> str:
        """The time at which the file was last written; empty where there is none."""
        try:
            return str(self._path.stat().st_mtime_ns)
        except OSError:
            return ""

    def text(self) -> str:
        """The page, made anew where the file has changed.

        Raises InputError where the file cannot be read and could not before.
        """
        with self._lock:
            stamp = self.stamp()
            if self._made is None or self._made[0] != stamp:
                self._made = stamp, self._page(stamp)
            return self._made[1]

    def _page(self, stamp: str) -> str:
        try:
            result = opened(self._path)
            if self._modes is not None:
                result = result._replace(dataset=with_stress(result.dataset, self._modes))
        except InputError as error:
            if self._made is None:
                raise
            result = Opened.nothing(str(error))
        with showing(self._path):
            return page_of(result, self._path.name, self._curves, live=STAMP, stamp=stamp)


class LiveServer(ThreadingHTTPServer):
    """A server that knows its names, so that no page of another site reads it under a name of its own, and
    that does not mind readers who leave."""

    @property
    def names(self) -> tuple[str, ...]:
        """The values of the header Host that are this server's."""
        return tuple(f"{name}:{self.server_port}" for name in ("127.0.0.1", "localhost"))

    def handle_error(self, request: Any, client_address: Any) -> None:
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


def server_of(
    path: Path, port: int = 0, curves: bool = True, modes: Path | None = None
) -> ThreadingHTTPServer:
    """A server for the page of a file, on this machine alone; port 0 is any free one.

    Raises InputError where the file cannot be read or the port is taken.
    """
    page = LivePage(path, curves, modes)

    class Handler(BaseHTTPRequestHandler):
        server: LiveServer

        def do_GET(self) -> None:
            if self.headers.get("Host", "") not in self.server.names:
                self.send_error(HTTPStatus.FORBIDDEN, "this server is called by other names")
                return
            texts = {"/": ("text/html", page.text), STAMP: ("text/plain", page.stamp)}
            kind, make = texts.get(self.path, ("text/plain", None))
            body = make().encode() if make else b"not here"
            self.send_response(HTTPStatus.OK if make else HTTPStatus.NOT_FOUND)
            self.send_header("Content-Type", f"{kind}; charset=utf-8")
            self.send_header("Content-Length", str(len(body)))
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: object) -> None:
            """Log nothing: the terminal is the user's."""

    try:
        return LiveServer(("127.0.0.1", port), Handler)
    except OSError as error:
        raise InputError(
            f"--port is {port}, which cannot be used: {error.strerror}; choose another"
        ) from None
    except OverflowError:
        raise InputError(f"--port is {port}; choose one from 0 (any that is free) to 65535") from None
