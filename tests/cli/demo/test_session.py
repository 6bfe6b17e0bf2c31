# SPDX-License-Identifier: Apache-2.0
"""The demo's processes are started, listened to and ended, whatever happens to them."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from safety_island.cli.demo import session
from safety_island.cli.demo.child import Child, how_it_ended
from safety_island.cli.demo.events import ARM, BRIDGE, ISLAND, VEHICLE, DemoState
from safety_island.cli.demo.session import DemoError, Session, bare
from safety_island.cli.stopping import StopFlag
from tests.cli.demo.samples import STATUS, TICK, VEHICLE_SUMMARY

SERVE = """
import signal, sys, threading
stop = threading.Event()
signal.signal(signal.SIGTERM, lambda *_: stop.set())
print({line!r}, flush=True)
while not stop.wait(0.01): pass
print({last!r}, flush=True)
"""


def child(name: str, code: str) -> Child:
    return Child(name, (), program=(sys.executable, "-c", code))


def server(name: str, line: object, last: object = None) -> Child:
    """A process that says one thing, and another when it is told to end."""
    texts = {"line": json.dumps(line), "last": json.dumps(last or {"event": "end"})}
    return child(name, SERVE.format(**texts))


def run(*children: Child) -> DemoState:
    running = Session(children, lambda state: None)
    try:
        running.run()
    finally:
        assert all(one.exit_code is not None for one in children), "all have ended"
    return running.state


def test_ends_when_the_main_compute_ends() -> None:
    code = f"input(); print({json.dumps(STATUS)!r}); print({json.dumps(VEHICLE_SUMMARY)!r})"
    island = server(ISLAND, TICK, {"event": "summary", "ticks": 3})
    bridge = server(BRIDGE, {"event": "counts", "forwarded": 5})
    program = (sys.executable, "-c", code)
    vehicle = Child(VEHICLE, (), program=program, is_controlled=True)

    def show(state: DemoState) -> None:
        if state.tick and state.forwarded:
            vehicle.say("drive")

    running = Session((island, bridge, vehicle), show)
    running.run()
    assert running.state.vehicle_summary == VEHICLE_SUMMARY
    assert running.state.island_summary["ticks"] == 3, "said when it was told to end"


@pytest.mark.parametrize("name", [ISLAND, BRIDGE])
def test_death_is_told_and_ends_the_others(name: str) -> None:
    dying = child(name, "import sys; print('no bus', file=sys.stderr); sys.exit(3)")
    other = BRIDGE if name == ISLAND else ISLAND
    with pytest.raises(DemoError, match=rf"{name} died \(exit code 3\); it said: no bus"):
        run(dying, server(other, TICK), server(VEHICLE, STATUS))


def test_killed_main_compute_is_told() -> None:
    dying = child(VEHICLE, "import os; os.kill(os.getpid(), 9)")
    with pytest.raises(DemoError, match=r"main-compute died \(signal SIGKILL\)"):
        run(server(ISLAND, TICK), dying)


def test_orderly_end_of_the_island_is_a_death_too() -> None:
    with pytest.raises(DemoError, match=r"island died \(exit code 0\)"):
        run(child(ISLAND, ""), server(VEHICLE, STATUS))


def test_vehicle_that_does_not_move_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "START_LIMIT_S", 0.2)
    with pytest.raises(
        DemoError, match=r"did not move within 0\.2 s: waiting for the main compute"
    ):
        run(server(ISLAND, TICK), child(VEHICLE, "import time; time.sleep(60)"))


def test_drive_that_takes_too_long_is_ended() -> None:
    vehicle = server(VEHICLE, STATUS, VEHICLE_SUMMARY)
    running = Session((server(ISLAND, TICK), vehicle), lambda state: None, limit_s=0.3)
    running.run()
    assert running.state.vehicle_summary == VEHICLE_SUMMARY


def test_heads_of_log_lines_are_left_out() -> None:
    assert bare("[INFO] [1795317816.618334] [node/node.py:70] is live") == "is live"
    kept = "[ERROR] [1795317816.618334] [node/node.py:70] no bus"
    assert bare(kept) == kept


def test_child_that_will_not_end_is_killed() -> None:
    code = "import signal, time; signal.signal(signal.SIGTERM, lambda *_: None)\n"
    stubborn = child(BRIDGE, code + "print('{}', flush=True)\nwhile True: time.sleep(1)")
    stubborn.start()
    while not list(stubborn.events()):
        time.sleep(0.01)
    stubborn.tell_to_stop()
    assert stubborn.wait(0.2) == -9
    stubborn.close()


def test_output_that_is_no_json_is_kept_as_words() -> None:
    talking = child(BRIDGE, "print('Traceback')")
    talking.start()
    talking.wait(30)
    assert list(talking.events()) == []
    assert talking.said == ["Traceback"]
    talking.close()


def test_configuration_of_the_user_does_not_reach_the_children(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("CYCLONEDDS_URI", "file:///nowhere.xml")
    asking = child(ISLAND, "import os, json; print(json.dumps(dict(os.environ)))")
    asking.start()
    asking.wait(30)
    (environment,) = asking.events()
    assert "CYCLONEDDS_URI" not in environment
    asking.close()


def test_how_it_ended() -> None:
    assert [how_it_ended(code) for code in (0, 3, -9, -99)] == [
        "exit code 0",
        "exit code 3",
        "signal SIGKILL",
        "signal 99",
    ]


NOTE_END = """
import json, os, signal, sys, threading, time
stop = threading.Event()
signal.signal(signal.SIGTERM, lambda *_: stop.set())
open({path!r} + "-" + {name!r}, "w").close()
while not all(os.path.exists({path!r} + "-" + name) for name in {others!r}): time.sleep(0.01)
for line in {lines!r}: print(json.dumps(line), flush=True)
while not stop.wait(0.01): pass
open({path!r}, "a").write({name!r} + "\\n")
"""


def noting(name: str, path: Path, *lines: object, others: Sequence[str] = ()) -> Child:
    """A process that says some things when others are there, and notes in a file that it ends."""
    return child(name, NOTE_END.format(lines=lines, path=str(path), name=name, others=others))


def test_those_who_listen_leave_before_those_who_speak(tmp_path: Path) -> None:
    """So that nobody sees another one go, and warns of it."""
    path = tmp_path / "order"
    vehicle = noting(VEHICLE, path, STATUS, VEHICLE_SUMMARY, others=(ISLAND, BRIDGE))
    island = noting(ISLAND, path, TICK | {"state": "READY"})
    run(vehicle, noting(BRIDGE, path), island)
    assert path.read_text().split() == [ISLAND, BRIDGE, VEHICLE]


def test_island_is_ended_when_it_has_seen_that_autonomous_mode_was_left(tmp_path: Path) -> None:
    path = tmp_path / "order"
    code = """
import json, sys, time
import signal
signal.signal(signal.SIGTERM, signal.SIG_IGN)
print(json.dumps({active!r}), flush=True)
open({path!r} + "-active", "w").close()
time.sleep(0.4)
open({path!r}, "a").write("ready\\n")
"""
    texts = {"active": TICK, "path": str(path)}
    # READY is said when SIGTERM is no longer ignored: it may come at once.
    ready = (TICK | {"state": "READY"},)
    end = NOTE_END.format(lines=ready, path=str(path), name=ISLAND, others=())
    island = child(ISLAND, code.format(**texts) + end)
    vehicle = noting(VEHICLE, path, STATUS, VEHICLE_SUMMARY, others=(BRIDGE, "active"))
    run(island, noting(BRIDGE, path), vehicle)
    assert path.read_text().split() == ["ready", ISLAND, BRIDGE, VEHICLE]


def test_one_who_asks_to_end_gets_the_summary_of_the_drive() -> None:
    code = f"""
print({json.dumps(STATUS)!r}, flush=True)
import sys
for line in sys.stdin:
    if line == "end\\n": print({json.dumps(VEHICLE_SUMMARY)!r}, flush=True)
"""
    vehicle = Child(VEHICLE, (), program=(sys.executable, "-c", code), is_controlled=True)
    stop = StopFlag()
    running = Session(
        (server(ISLAND, TICK | {"state": "READY"}), vehicle),
        lambda state: stop.set() if state.is_driving else None,
        stop=stop,
    )
    running.run()
    assert running.state.vehicle_summary == VEHICLE_SUMMARY


def test_end_during_the_start_asks_for_nothing() -> None:
    stop = StopFlag()
    running = Session(
        (server(ISLAND, TICK), server(VEHICLE, STATUS | {"gate": "waiting"})),
        lambda _: stop.set(),
        stop=stop,
    )
    running.run()
    assert not running.state.has_driven
    assert running.state.vehicle_summary == {}


def test_a_child_that_a_key_kills_is_no_failure() -> None:
    stop = StopFlag()
    bridge = server(BRIDGE, {"event": "counts", "forwarded": 1})

    def show(state: DemoState) -> None:
        if running.find(BRIDGE) is bridge:
            running.drop(bridge, kill=True)
            running.add(server(BRIDGE, {"event": "counts", "forwarded": 77}))
        elif state.forwarded == 77:
            stop.set()

    running = Session((bridge, server(VEHICLE, STATUS)), show, stop=stop)
    running.run()
    assert bridge.exit_code == -9
    assert running.state.forwarded == 77


def test_the_answer_to_a_request_to_arm_is_a_message_and_no_death() -> None:
    stop = StopFlag()

    def show(state: DemoState) -> None:
        if any("arm: refused" in message for message in state.messages):
            stop.set()

    arm = child(ARM, "import sys; print('refused: the trajectory is stale'); sys.exit(1)")
    running = Session((server(VEHICLE, STATUS), arm), show, stop=stop)
    running.run()
    assert "arm: refused: the trajectory is stale" in running.state.messages
