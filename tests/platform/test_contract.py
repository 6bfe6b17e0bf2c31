"""What every backend of the platform promises; each test runs on each of them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from safety_island.errors import ConfigurationError
from safety_island.platform import BACKENDS, LogConfig, LogLevel, NetworkError, load
from tests.platform.rig import Rig, open_rig

PERIOD_S = 0.02


@pytest.fixture(params=sorted(BACKENDS))
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Rig]:
    with open_rig(request.param, tmp_path) as opened:
        yield opened


def test_an_unknown_platform_is_refused_with_the_list() -> None:
    with pytest.raises(ConfigurationError, match=r"'amiga' is unknown: choose one of posix, sim"):
        load("amiga")


def test_a_platform_knows_its_name(rig: Rig) -> None:
    assert load(rig.platform.name).name == rig.platform.name


class TestClock:
    def test_monotonic_time_never_goes_back(self, rig: Rig) -> None:
        times = [rig.platform.clock.monotonic_ns() for _ in range(1000)]
        assert times == sorted(times)

    def test_an_offset_moves_the_wall_clock_and_nothing_else(self, rig: Rig) -> None:
        clock = rig.platform.clock
        before = clock.monotonic_ns()
        clock.set_wall_offset_ns(3600 * 10**9)
        low, wall, high = clock.monotonic_ns(), clock.wall_ns(), clock.monotonic_ns()
        assert before <= low <= wall - 3600 * 10**9 <= high
        assert low * 1e-9 - 1e-3 <= clock.now() - 3600.0

    def test_without_an_offset_the_machine_s_own_wall_clock_counts(self, rig: Rig) -> None:
        clock = rig.platform.clock
        own = clock.wall_ns()
        clock.set_wall_offset_ns(-clock.monotonic_ns())
        clock.set_wall_offset_ns(None)
        assert clock.wall_ns() >= own


class TestTimer:
    def test_ticks_stand_on_the_grid(self, rig: Rig) -> None:
        timer = rig.platform.new_timer(PERIOD_S)
        ticks = [timer.wait() for _ in range(5)]
        timer.close()
        assert timer.period_ns == 20_000_000
        for before, after in pairwise(ticks):
            assert before is not None and after is not None
            assert after.due_ns - before.due_ns == (1 + after.skipped) * timer.period_ns
            assert 0 <= after.lateness_ns <= timer.period_ns // 2

    def test_no_tick_comes_before_its_time(self, rig: Rig) -> None:
        timer = rig.platform.new_timer(PERIOD_S)
        tick = timer.wait()
        timer.close()
        assert tick is not None
        assert rig.platform.clock.monotonic_ns() >= tick.due_ns

    @pytest.mark.parametrize("periods", [2.7, 5.7])
    def test_missed_ticks_are_skipped_and_counted(self, rig: Rig, periods: float) -> None:
        timer = rig.platform.new_timer(PERIOD_S)
        first = timer.wait()
        rig.busy(periods * PERIOD_S)
        second = timer.wait()
        third = timer.wait()
        timer.close()
        assert first is not None and second is not None and third is not None
        assert second.skipped >= int(periods)
        assert timer.skipped == first.skipped + second.skipped + third.skipped
        assert timer.ticks == 3
        starts = [tick.due_ns + tick.lateness_ns for tick in (first, second, third)]
        assert starts[2] - starts[1] >= timer.period_ns // 2  # no burst

    def test_a_wall_clock_step_moves_no_tick(self, rig: Rig) -> None:
        timer = rig.platform.new_timer(PERIOD_S)
        first = timer.wait()
        rig.platform.clock.set_wall_offset_ns(-3600 * 10**9)
        second = timer.wait()
        timer.close()
        assert first is not None and second is not None
        assert second.due_ns - first.due_ns == (1 + second.skipped) * timer.period_ns

    def test_wake_ends_the_wait(self, rig: Rig) -> None:
        timer = rig.platform.new_timer(3600.0)
        rig.later(0.01, timer.wake)
        assert timer.wait() is None
        assert timer.ticks == 0
        timer.close()

    def test_wake_before_the_wait_ends_the_next_one_only(self, rig: Rig) -> None:
        timer = rig.platform.new_timer(PERIOD_S)
        for _ in range(100_000):
            timer.wake()
        assert timer.wait() is None
        assert timer.wait() is not None
        timer.close()

    @pytest.mark.parametrize("period", [0.0, -1.0, float("nan"), float("inf"), 1e9])
    def test_an_impossible_period_is_refused(self, rig: Rig, period: float) -> None:
        with pytest.raises(ConfigurationError, match=r"timer period .* cannot be used"):
            rig.platform.new_timer(period)


class TestLogger:
    def test_a_line_has_time_level_call_site_and_text(self, rig: Rig) -> None:
        logger, lines = rig.logger(LogConfig())
        logger.info("steering %.2f rad", 0.125)
        (line,) = lines()
        pattern = r"\[INFO\] \[\d+\.\d{6}\] \[platform/test_contract\.py:\d+\] steering 0\.12 rad"
        assert re.fullmatch(pattern, line)

    def test_json_lines_hold_the_same(self, rig: Rig) -> None:
        logger, lines = rig.logger(LogConfig(json=True))
        logger.warning("two\nlines", site="dds")
        document = json.loads(lines()[0])
        assert document.pop("time") > 0
        assert document == {"level": "warn", "site": "dds", "message": "two\nlines"}

    def test_a_plain_line_is_one_line_whatever_the_text_holds(self, rig: Rig) -> None:
        logger, lines = rig.logger(LogConfig())
        logger.error("first\nsecond\r\x85third")
        assert len(lines()) == 1

    @pytest.mark.parametrize(
        ("level", "expected"),
        [
            (LogLevel.NONE, []),
            (LogLevel.NORMAL, ["ERROR", "WARN", "INFO"]),
            (LogLevel.DEBUG, ["ERROR", "WARN", "INFO", "DEBUG"]),
        ],
    )
    def test_levels(self, rig: Rig, level: LogLevel, expected: list[str]) -> None:
        logger, lines = rig.logger(LogConfig(level=level))
        for log in (logger.error, logger.warning, logger.info, logger.debug):
            log("text")
        assert [line[1 : line.index("]")] for line in lines()] == expected

    def test_a_throttled_call_site_logs_once_in_an_interval(self, rig: Rig) -> None:
        logger, lines = rig.logger(LogConfig(throttle_s=1000.0))
        for count in range(5):
            logger.info("first site %d", count, throttled=True)
            logger.info("second site %d", count, throttled=True)
            logger.info("free %d", count)
        texts = [line.split("] ")[-1] for line in lines()]
        assert texts == ["first site 0", "second site 0", *[f"free {n}" for n in range(5)]]

    def test_a_throttled_call_site_logs_again_after_the_interval(self, rig: Rig) -> None:
        logger, lines = rig.logger(LogConfig(throttle_s=0.01))
        for count in range(2):
            logger.info("now %d", count, throttled=True)
            rig.busy(0.011)
        assert len(lines()) == 2

    def test_a_wall_clock_step_silences_no_call_site(self, rig: Rig) -> None:
        logger, lines = rig.logger(LogConfig(throttle_s=0.01))
        for hour in range(2):
            logger.info("now", throttled=True)
            rig.platform.clock.set_wall_offset_ns(-hour * 3600 * 10**9)
            rig.busy(0.011)
        assert len(lines()) == 2

    def test_a_named_site_is_throttled_by_its_name(self, rig: Rig) -> None:
        logger, lines = rig.logger(LogConfig(throttle_s=1000.0))
        for name in ("odometry", "steering", "odometry"):
            logger.info("Waiting for %s data", name, throttled=True, site=f"node.{name}")
        assert [line.split("] [")[2] for line in lines()] == [
            "node.odometry] Waiting for odometry data",
            "node.steering] Waiting for steering data",
        ]

    def test_a_sink_that_takes_nothing_costs_lines_and_no_time(self, rig: Rig) -> None:
        logger = rig.jammed_logger(LogConfig(capacity=8))
        for count in range(30):
            logger.info("flood %d", count)
        assert 30 - 8 - 1 <= logger.dropped <= 30 - 8

    def test_lines_come_in_order_and_none_is_lost(self, rig: Rig) -> None:
        logger, lines = rig.logger(LogConfig(capacity=1000))
        for count in range(500):
            logger.info("%d", count)
        assert [int(line.split()[-1]) for line in lines()] == list(range(500))
        assert logger.dropped == 0


class TestNetwork:
    def test_an_interface_with_an_address_is_ready_at_once(self, rig: Rig) -> None:
        network = rig.platform.network
        address = network.wait_for_address(rig.interface, limit_s=0.0)
        assert address is not None and address == network.address(rig.interface)
        assert address in network.describe(rig.interface)

    def test_a_missing_interface_is_an_error_that_names_those_there_are(self, rig: Rig) -> None:
        pattern = rf"'nosuch0' has no IPv4 address after 0\.01 s .*no such.*{rig.interface}"
        with pytest.raises(NetworkError, match=pattern):
            rig.platform.network.wait_for_address("nosuch0", limit_s=0.01)
        assert rig.platform.network.address("nosuch0") is None

    def test_a_name_that_only_begins_like_an_interface_is_another(self, rig: Rig) -> None:
        assert rig.platform.network.address(rig.interface + "x" * 20) is None

    def test_a_stop_ends_the_wait(self, rig: Rig) -> None:
        network = rig.platform.network
        assert network.wait_for_address("nosuch0", 1000.0, stopped=lambda: True) is None


def test_stopping_is_not_called_without_a_reason(rig: Rig) -> None:
    calls: list[int] = []
    with rig.platform.on_stop(lambda: calls.append(1)):
        pass
    assert calls == []
