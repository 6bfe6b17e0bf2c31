# SPDX-License-Identifier: Apache-2.0
"""What ``island run`` logs follows LOG_LEVEL, LOG_THROTTLE_RATE, DDS_LOG_LEVEL and --log-json."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

from safety_island.dds.config import DdsConfig, defaults_xml
from safety_island.errors import ConfigurationError

pytestmark = pytest.mark.live

WAITING = "Waiting for trajectory data, odometry data, "
LIBRARY = "config: Domain/General"
"""How CycloneDDS tells its configuration."""


def logged(domain_id: int, *words: str, **environment: str) -> list[str]:
    """Run for half a second without input; return the lines of standard error."""
    command = [sys.executable, "-m", "safety_island", "run", "--domain", str(domain_id)]
    command += ["--duration", "0.5", "--period", "0.05", *words]
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=110, env={**os.environ, **environment}
    )
    assert done.returncode == 0, done.stderr
    return [line for line in done.stderr.splitlines() if not line.startswith(("note:", "island:"))]


def test_as_configured_by_default(domain_id: int) -> None:
    lines = logged(domain_id)
    assert sum(WAITING in line for line in lines) == 1
    assert not any(LIBRARY in line for line in lines)
    assert all(line.startswith("[INFO] ") for line in lines)


def test_level_0_logs_nothing(domain_id: int) -> None:
    assert logged(domain_id, "-D", "LOG_LEVEL=0") == []


def test_throttle_rate_0_logs_every_time(domain_id: int) -> None:
    lines = logged(domain_id, "-D", "LOG_THROTTLE_RATE=0")
    assert sum(WAITING in line for line in lines) > 1


def test_json_lines(domain_id: int) -> None:
    lines = [json.loads(line) for line in logged(domain_id, "--log-json")]
    assert {line["level"] for line in lines} == {"info"}
    assert any(WAITING in line["message"] for line in lines)


def test_dds_log_level(domain_id: int) -> None:
    warnings = logged(domain_id, "-D", "DDS_LOG_LEVEL=1")
    everything = logged(domain_id, "-D", "DDS_LOG_LEVEL=2")
    assert any(LIBRARY in line for line in warnings)
    assert any(LIBRARY in line for line in everything)
    assert len(everything) > 2 * len(warnings)


def test_dds_log_level_with_xml_of_the_user(domain_id: int) -> None:
    xml = "<Domain><Discovery><Tag>mine</Tag></Discovery></Domain>"
    xml = f"<CycloneDDS>{xml}</CycloneDDS>"
    lines = logged(
        domain_id,
        "-D",
        "DDS_LOG_LEVEL=1",
        CYCLONEDDS_URI=xml,
    )
    assert any("config: Domain/Discovery/Tag/#text: mine" in line for line in lines)


def test_xml_of_the_log_levels() -> None:
    assert "Tracing" not in DdsConfig().xml(1) + defaults_xml()
    for level, verbosity in ((1, "config"), (2, "finest")):
        tracing = f"<Tracing><Verbosity>{verbosity}</Verbosity><OutputFile>stderr</OutputFile>"
        assert tracing in DdsConfig(log_level=level).xml(1)
        assert tracing in defaults_xml(log_level=level)
    with pytest.raises(ConfigurationError, match="log_level is 3, expected 0 to 2"):
        DdsConfig(log_level=3)
