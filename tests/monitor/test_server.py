# SPDX-License-Identifier: Apache-2.0
"""The server: who may read, who may act, a port in use, a page that reads nothing."""

from __future__ import annotations

import asyncio
import json
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus

from safety_island.errors import IslandError
from safety_island.monitor.fields import FIELDS
from safety_island.monitor.hub import Hub
from safety_island.monitor.server import WRONG_TOKEN, PageServer, Place

TOKEN = "a-token"
ORIGIN = "http://127.0.0.1"


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


class Scene:
    """A server on a free port, and what was pressed on it."""

    def __init__(self, address: str = "127.0.0.1", token: str = TOKEN) -> None:
        self.hub = Hub({"title": "test"})
        self.pressed: list[str] = []
        place = Place(address, free_port(), token)
        self.server = PageServer(self.hub, place, self.pressed.append)

    async def get(self, path: str, host: str = "") -> tuple[int, dict[str, str], bytes]:
        """Ask for a file as a browser does."""
        port = self.server.port
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        name = host or f"127.0.0.1:{port}"
        writer.write(f"GET {path} HTTP/1.1\r\nHost: {name}\r\n\r\n".encode())
        head, _, body = (await reader.read()).partition(b"\r\n\r\n")
        writer.close()
        first, *lines = head.decode().split("\r\n")
        return int(first.split()[1]), dict(line.split(": ", 1) for line in lines), body

    @asynccontextmanager
    async def page(self, **options: Any) -> AsyncIterator[ClientConnection]:
        """Open the data of the page, by default as the page itself."""
        address = f"127.0.0.1:{self.server.port}"
        options = {"origin": f"http://{address}"} | options
        async with connect(f"ws://{address}/data", compression=None, **options) as connection:
            yield connection


def run(test: Callable[[Scene], Awaitable[None]], scene: Scene | None = None) -> Scene:
    """Run a test while a server serves."""
    scene = scene or Scene()

    async def body() -> None:
        async with scene.server.serving(), asyncio.timeout(30):
            await test(scene)

    asyncio.run(body())
    return scene


async def until(connection: ClientConnection, kind: str) -> dict[str, Any]:
    """Wait for a message of a kind."""
    while True:
        for message in json.loads(await connection.recv()):
            if message["kind"] == kind:
                found: dict[str, Any] = message
                return found


def test_files_come_with_the_policy() -> None:
    async def test(scene: Scene) -> None:
        status, headers, body = await scene.get("/")
        assert status == 200
        assert "script-src 'self'" in headers["Content-Security-Policy"]
        assert body.startswith(b"<!doctype html>")
        assert (await scene.get("/main.js?x=1"))[0] == 200
        for path in ("/../server.py", "/server.py", "/%2e%2e/server.py", "//etc/passwd"):
            assert (await scene.get(path))[0] == 404

    run(test)


def test_a_foreign_name_and_a_foreign_page_are_refused() -> None:
    async def test(scene: Scene) -> None:
        assert (await scene.get("/", host="attacker.example"))[0] == 403
        with pytest.raises(InvalidStatus, match="403"):
            async with scene.page(origin="http://attacker.example"):
                pass
        async with scene.page(origin=None) as connection:  # no browser
            assert (await until(connection, "hello"))["title"] == "test"

    run(test)


def test_values_come_as_they_are_published() -> None:
    async def test(scene: Scene) -> None:
        async with scene.page() as connection:
            await until(connection, "hello")
            scene.hub.publish("pose", {"x": 1.5})
            assert await until(connection, "pose") == {"kind": "pose", "x": 1.5}

    run(test)


def test_buttons_need_the_token() -> None:
    async def test(scene: Scene) -> None:
        async with scene.page() as connection:
            for message in ('{"press":"nan"}', '{"press":"nan","token":"b"}'):
                await connection.send(message)
                await until(connection, "refused")
            assert scene.pressed == []
            for nonsense in ("", "[]", "7", "{", "[" * 1000, '{"token":"a-token"}'):
                await connection.send(nonsense)
            await connection.send(json.dumps({"press": "nan", "token": TOKEN}))
            await connection.send(json.dumps({"press": "jump"}))
            await until(connection, "refused")

    assert run(test).pressed == ["nan"]


def test_without_a_token_nobody_presses() -> None:
    async def test(scene: Scene) -> None:
        async with scene.page() as connection:
            await connection.send('{"press":"nan","token":""}')
            await until(connection, "refused")

    assert run(test, Scene(token="")).pressed == []


def test_bound_elsewhere_reading_needs_the_token() -> None:
    async def test(scene: Scene) -> None:
        async with scene.page() as connection:
            await connection.send('{"token":"wrong"}')
            with pytest.raises(ConnectionClosed) as closed:
                await connection.recv()
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == WRONG_TOKEN
        async with scene.page() as connection:
            await connection.send(json.dumps({"token": TOKEN}))
            await until(connection, "hello")

    run(test, Scene("0.0.0.0"))


def test_a_message_that_is_too_long_ends_the_connection() -> None:
    async def test(scene: Scene) -> None:
        async with scene.page() as connection:
            await connection.send("x" * 5000)
            with pytest.raises(ConnectionClosed):
                while True:
                    await connection.recv()

    run(test)


def test_a_page_that_reads_nothing_is_not_waited_for() -> None:
    """Another page goes on, and what waits for the stuck one is bounded."""

    async def test(scene: Scene) -> None:
        async with scene.page(max_queue=1) as stuck, scene.page() as other:
            await until(other, "hello")
            long = "x" * 50_000
            for number in range(400):  # 20 MB, far beyond what sockets hold
                scene.hub.publish("path", {"number": number, "text": long})
                scene.hub.add_row([0.0] * len(FIELDS), [0.0])
                assert (await until(other, "path"))["number"] == number
            assert max(client.dropped for client in scene.hub.clients) > 0
            stuck.transport.abort()

    run(test)


def test_a_port_in_use_is_passed_over_and_the_address_says_which() -> None:
    first = Scene()

    async def test(scene: Scene) -> None:
        second = Scene()
        second.server._place = Place("127.0.0.1", scene.server.port, "")
        async with second.server.serving():
            assert second.server.port > scene.server.port
            assert second.server.address == f"http://127.0.0.1:{second.server.port}/"

    run(test, first)
    assert first.server.address == f"http://127.0.0.1:{first.server.port}/#{TOKEN}"


def test_an_address_that_is_not_ours_is_one_line() -> None:
    async def test() -> None:
        server = PageServer(Hub({}), Place("203.0.113.7", free_port(), "t"))
        async with server.serving():
            pass

    with pytest.raises(IslandError, match=r"--bind: 203\.0\.113\.7 port \d+ cannot be used"):
        asyncio.run(test())
