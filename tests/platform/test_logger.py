# SPDX-License-Identifier: Apache-2.0
"""What every logger promises."""

from __future__ import annotations

import json
import re

import pytest

from safety_island.platform import LogConfig, LogLevel
from tests.platform.rig import Rig


def test_a_line_has_time_level_call_site_and_text(rig: Rig) -> None:
    logger, lines = rig.logger(LogConfig())
    logger.info("steering %.2f rad", 0.125)
    (line,) = lines()
    pattern = r"\[INFO\] \[\d+\.\d{6}\] \[platform/test_logger\.py:\d+\] steering 0\.12 rad"
    assert re.fullmatch(pattern, line)


def test_json_lines_hold_the_same(rig: Rig) -> None:
    logger, lines = rig.logger(LogConfig(json=True))
    logger.warning("two\nlines", site="dds")
    document = json.loads(lines()[0])
    assert document.pop("time") > 0
    assert document == {"level": "warn", "site": "dds", "message": "two\nlines"}


def test_a_plain_line_is_one_line_whatever_the_text_holds(rig: Rig) -> None:
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
def test_levels(rig: Rig, level: LogLevel, expected: list[str]) -> None:
    logger, lines = rig.logger(LogConfig(level=level))
    for log in (logger.error, logger.warning, logger.info, logger.debug):
        log("text")
    assert [line[1 : line.index("]")] for line in lines()] == expected


def test_a_throttled_call_site_logs_once_in_an_interval(rig: Rig) -> None:
    logger, lines = rig.logger(LogConfig(throttle_s=1000.0))
    for count in range(5):
        logger.info("first site %d", count, throttled=True)
        logger.info("second site %d", count, throttled=True)
        logger.info("free %d", count)
    texts = [line.split("] ")[-1] for line in lines()]
    assert texts == ["first site 0", "second site 0", *[f"free {n}" for n in range(5)]]


def test_a_throttled_call_site_logs_again_after_the_interval(rig: Rig) -> None:
    logger, lines = rig.logger(LogConfig(throttle_s=0.01))
    for count in range(2):
        logger.info("now %d", count, throttled=True)
        rig.busy(0.011)
    assert len(lines()) == 2


def test_a_wall_clock_step_silences_no_call_site(rig: Rig) -> None:
    logger, lines = rig.logger(LogConfig(throttle_s=0.01))
    for hour in range(2):
        logger.info("now", throttled=True)
        rig.platform.clock.set_wall_offset_ns(-hour * 3600 * 10**9)
        rig.busy(0.011)
    assert len(lines()) == 2


def test_a_named_site_is_throttled_by_its_name(rig: Rig) -> None:
    logger, lines = rig.logger(LogConfig(throttle_s=1000.0))
    for name in ("odometry", "steering", "odometry"):
        logger.info("Waiting for %s data", name, throttled=True, site=f"node.{name}")
    assert [line.split("] [")[2] for line in lines()] == [
        "node.odometry] Waiting for odometry data",
        "node.steering] Waiting for steering data",
    ]


def test_a_sink_that_takes_nothing_costs_lines_and_no_time(rig: Rig) -> None:
    logger = rig.jammed_logger(LogConfig(capacity=8))
    for count in range(30):
        logger.info("flood %d", count)
    assert 30 - 8 - 1 <= logger.dropped <= 30 - 8


def test_lines_come_in_order_and_none_is_lost(rig: Rig) -> None:
    logger, lines = rig.logger(LogConfig(capacity=1000))
    for count in range(500):
        logger.info("%d", count)
    assert [int(line.split()[-1]) for line in lines()] == list(range(500))
    assert logger.dropped == 0
