"""A small server of this machine: it serves what it was given, and notes everybody who comes."""

from __future__ import annotations

import contextlib
import http.server
import threading
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field


@dataclass
class Server:
    """A server on 127.0.0.1; what it was asked for, and how many connections were made."""

    port: int
    paths: list[str] = field(default_factory=list)
    connections: int = 0


@contextlib.contextmanager
def listening(pages: Mapping[str, bytes] | None = None) -> Iterator[Server]:
    """A server that runs as long as the block. pages: HTML by path; others are empty."""
    held = dict(pages or {})
    seen = Server(0)

    class Handler(http.server.BaseHTTPRequestHandler):
        def setup(self) -> None:
            seen.connections += 1
            super().setup()

        def do_GET(self) -> None:
            seen.paths.append(self.path)
            body = held.get(self.path, b"")
            self.send_response(200)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            with contextlib.suppress(OSError):
                self.wfile.write(body)

        do_POST = do_HEAD = do_OPTIONS = do_GET

        def log_message(self, *words: object) -> None:
            pass

    class Quiet(http.server.ThreadingHTTPServer):
        daemon_threads = True

        def handle_error(self, request: object, client_address: object) -> None:
            pass  # a browser that hangs up

    with Quiet(("127.0.0.1", 0), Handler) as server:
        seen.port = server.server_address[1]
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        try:
            yield seen
        finally:
            server.shutdown()
            thread.join()
