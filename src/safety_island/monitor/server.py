# SPDX-License-Identifier: Apache-2.0
"""Serves the page and its data: files over HTTP, the rest over one WebSocket a page."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import json
import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from safety_island.errors import IslandError
from safety_island.monitor.access import holds, is_loopback, is_own_host, is_own_origin
from safety_island.monitor.files import HEADERS, StaticFile, load_page
from safety_island.monitor.hub import Client, Hub

DATA_PATH = "/data"
PORTS_TRIED = 50
MOST_CLIENTS = 32
SEND_EVERY_S = 0.03
"""At least so long [s] between two messages to a page: what came meanwhile goes together."""
LONGEST_MESSAGE = 1024
"""From a page [byte]."""
GREETING_LIMIT_S = 5.0
"""Within this time [s] a page must show its token where one is needed to read."""
WRONG_TOKEN = 4401
"""Close code of a WebSocket that may not read."""
TOO_MANY = 4429
_LOGGER = logging.getLogger("safety_island.monitor")
_LOGGER.addHandler(logging.NullHandler())
_LOGGER.propagate = False


@dataclass(frozen=True)
class Place:
    """Where to serve. ``token``: empty for none; who is not on this machine needs it to read."""

    address: str = "127.0.0.1"
    port: int = 8140
    token: str = ""


class PageServer:
    """The server; ``press`` is told of each button that somebody with the token presses."""

    def __init__(self, hub: Hub, place: Place, press: Callable[[str], None] | None = None) -> None:
        self._hub, self._place, self._press = hub, place, press
        self._files = load_page()
        self._is_local = is_loopback(place.address)
        self.port = place.port
        """The one that is served on: the next free one where the wanted one is in use."""

    @property
    def address(self) -> str:
        """What to open in a browser; it holds the token, which a browser does not send on."""
        name = self._place.address
        shown = f"[{name}]" if ":" in name else name
        token = f"#{self._place.token}" if self._place.token else ""
        return f"http://{shown}:{self.port}/{token}"

    @asynccontextmanager
    async def serving(self) -> AsyncIterator[None]:
        """Serve while the context lasts. Raises IslandError when nothing can be bound."""
        server = await self._bind()
        try:
            yield
        finally:
            server.close()
            await server.wait_closed()

    async def _bind(self) -> Server:
        first = self._place.port
        for port in range(first, min(first + PORTS_TRIED, 65536)):
            try:
                server = await self._listen(port)
            except OSError as error:
                if error.errno != errno.EADDRINUSE:
                    raise IslandError(
                        f"--bind: {self._place.address} port {port} cannot be used"
                        f" ({error.strerror}); name an address of this machine ('ip address')"
                    ) from None
                continue
            self.port = port or server.sockets[0].getsockname()[1]
            return server
        raise IslandError(
            f"--port: {first} and the {PORTS_TRIED - 1} ports after it are in use; name another"
        )

    async def _listen(self, port: int) -> Server:
        return await serve(
            self._serve_page,
            self._place.address,
            port,
            process_request=self._answer,
            compression=None,
            max_size=LONGEST_MESSAGE,
            logger=_LOGGER,
            server_header=None,
        )

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """Return the answer to a request; None lets a WebSocket open."""
        host = request.headers.get("Host")
        if not is_own_host(host, self.port, loopback=self._is_local):
            return connection.respond(403, "this server goes by another name\n")
        path = request.path.partition("?")[0]
        if path == DATA_PATH:
            if is_own_origin(request.headers.get("Origin"), host):
                return None
            return connection.respond(403, "only the page of this server may read\n")
        found = self._files.get(path)
        return _file(found) if found else connection.respond(404, "there is no such file\n")

    async def _serve_page(self, connection: ServerConnection) -> None:
        if len(self._hub.clients) >= MOST_CLIENTS:
            await connection.close(
                TOO_MANY, f"{MOST_CLIENTS} pages are open, the most there may be"
            )
            return
        with contextlib.suppress(ConnectionClosed):
            if not self._is_local and not await self._greeted(connection):
                await connection.close(WRONG_TOKEN, "the token of the address is missing or wrong")
                return
            client, messages = self._hub.join()
            sender = asyncio.create_task(_send(connection, client, messages))
            try:
                async for message in connection:
                    await self._take(connection, message)
            finally:
                self._hub.leave(client)
                sender.cancel()

    async def _greeted(self, connection: ServerConnection) -> bool:
        try:
            async with asyncio.timeout(GREETING_LIMIT_S):
                return self._may_act(_read(await connection.recv()))
        except TimeoutError:
            return False

    async def _take(self, connection: ServerConnection, message: str | bytes) -> None:
        """Obey a page, if it may act; say when it may not."""
        asked = _read(message)
        if "press" not in asked or self._press is None:
            return
        if self._may_act(asked):
            self._press(str(asked["press"]))
        else:
            await connection.send('[{"kind":"refused"}]')

    def _may_act(self, asked: dict[str, Any]) -> bool:
        return holds(asked.get("token"), self._place.token)


async def _send(connection: ServerConnection, client: Client, messages: list[str]) -> None:
    """Bring a page up to date and keep it so; each send waits until the page has read enough."""
    with contextlib.suppress(ConnectionClosed):
        for message in messages:
            await connection.send(message)
        while True:
            await client.wakeup.wait()
            await connection.send(client.take())
            await asyncio.sleep(SEND_EVERY_S)


def _read(message: str | bytes) -> dict[str, Any]:
    """Return a message of a page; an empty one when it makes no sense."""
    try:
        found = json.loads(message)
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def _file(found: StaticFile) -> Response:
    headers = Headers(
        {
            "Content-Type": found.content_type,
            "Content-Length": str(len(found.body)),
            "Connection": "close",
            **HEADERS,
        }
    )
    return Response(200, "OK", headers, found.body)
