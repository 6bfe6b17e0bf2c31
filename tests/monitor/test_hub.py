# SPDX-License-Identifier: Apache-2.0
"""What waits for a page: bounded, newest first served, and all of it for one that comes late."""

from __future__ import annotations

import json
import os
from typing import Any

from safety_island.monitor.console import Console
from safety_island.monitor.fields import FIELDS
from safety_island.monitor.hub import MOST_MARKS, MOST_ROWS, Client, Hub


def kinds(text: str) -> list[str]:
    return [message["kind"] for message in json.loads(text)]


def taken(client: Client) -> dict[str, Any]:
    return {message["kind"]: message for message in json.loads(client.take())}


def test_of_everything_but_rows_and_marks_the_newest_only() -> None:
    hub = Hub({})
    client, _ = hub.join()
    for x in range(1000):
        hub.publish("pose", {"x": x})
    found = json.loads(client.take())
    assert found == [{"kind": "pose", "x": 999}]
    assert json.loads(client.take()) == []


def test_a_page_that_reads_nothing_costs_no_more_than_its_bounds() -> None:
    hub = Hub({})
    client, _ = hub.join()
    for t in range(10_000):
        hub.add_row([float(t)] * len(FIELDS), [float(t)])
        hub.add_mark(float(t), "text", "state")
    found = json.loads(client.take())
    (rows,) = (message for message in found if message["kind"] == "rows")
    assert len(rows["rows"]) == MOST_ROWS
    assert rows["rows"][-1] == [9999.0]
    assert rows["dropped"] == 10_000 - MOST_ROWS
    assert kinds(json.dumps(found)).count("mark") == MOST_MARKS


def test_one_that_comes_late_receives_what_was() -> None:
    hub = Hub({"title": "x"})
    hub.add_row([1.0] * len(FIELDS), [1.0])
    hub.add_mark(2.0, "bridge killed", "fault")
    hub.publish("path", {"x": [1.0]})
    client, messages = hub.join()
    assert [kind for text in messages for kind in kinds(text)] == ["hello", "rows", "mark", "path"]
    assert not client.wakeup.is_set()


def test_what_came_last_is_sent_last() -> None:
    hub = Hub({})
    client, _ = hub.join()
    for kind in ("silence", "summary", "silence"):
        hub.publish(kind, {})
    assert kinds(client.take()) == ["summary", "silence"]
    assert kinds(hub.join()[1][-1]) == ["summary", "silence"]


def test_one_that_has_left_is_forgotten() -> None:
    hub = Hub({})
    client, _ = hub.join()
    hub.leave(client)
    hub.publish("pose", {})
    assert json.loads(client.take()) == []


def test_lines_of_the_program_that_started_it() -> None:
    reading, writing = os.pipe()
    hub, console = Hub({}), Console(reading)
    client, _ = hub.join()
    console.poll(hub, 1.0)
    lines = (
        '{"event":"mark","text":"bridge killed","of":"fault"}',
        '{"event":"buttons","buttons":[{"key":"nan"}]}',
        '{"event":"can","can":{"frames":["123#00"]}}',
        '{"event":"mark","text":"x","of":"nonsense"}',
        '{"event":"unknown"}',
    )
    os.write(writing, "\n".join(lines).encode())
    console.poll(hub, 2.0)
    os.write(writing, b"\n")
    console.poll(hub, 2.0)
    found = taken(client)
    assert set(found) == {"mark", "buttons", "can"}
    assert found["mark"] == {"kind": "mark", "t": 2.0, "text": "bridge killed", "of": "fault"}
    os.close(writing)
    console.poll(hub, 3.0)
    assert console.is_closed
    os.close(reading)
