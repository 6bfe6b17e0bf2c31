"""DDS domains of this process: one library object for each id, shared by its participants."""

from __future__ import annotations

import re
import threading
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain

from safety_island.dds import binding
from safety_island.dds.config import URI, DdsConfig, check_domain_id, defaults_xml, user_xml
from safety_island.dds.errors import DdsError
from safety_island.dds.network import check_peer
from safety_island.dds.receive_filter import Sockets, opened_sockets
from safety_island.dds.stderr import captured_stderr
from safety_island.errors import ConfigurationError


@dataclass
class _Open:
    domain: Domain
    interfaces: frozenset[int]
    xml: str
    users: int


_lock = threading.Lock()
_open: dict[int, _Open] = {}


def open_domain(domain_id: int, config: DdsConfig) -> None:
    """Start a domain, or share the one that this process has under the same configuration.

    Raises ConfigurationError with the library's own words when it refuses the configuration.
    """
    check_domain_id(domain_id)
    binding.check_version()
    xml = _effective_xml(domain_id, config)
    with _lock:
        found = _open.get(domain_id)
        if found is None:
            _open[domain_id] = _Open(*_start(domain_id, xml), xml, 1)
        elif found.xml != xml:
            raise ConfigurationError(
                f"domain {domain_id} is already open in this process with another configuration"
            )
        else:
            found.users += 1


@contextmanager
def closed_to_other_interfaces(domain_id: int) -> Iterator[None]:
    """Close what sockets are opened inside as the domain's own are (one for each participant).

    Raises DdsError when they cannot be closed.
    """
    with _lock:
        with opened_sockets() as opened:
            yield
        opened.receive_only_from(_open[domain_id].interfaces)


def close_domain(domain_id: int) -> None:
    """Give a domain back; the last one to do so ends it."""
    with _lock:
        found = _open[domain_id]
        found.users -= 1
        if not found.users:
            del _open[domain_id]
            binding.delete(found.domain)


def _effective_xml(domain_id: int, config: DdsConfig) -> str:
    uri = user_xml()
    if uri is None:
        config.check_network()
        return config.xml(domain_id)
    for part in _parts(uri):
        _check_user_xml(part)
    return f"{defaults_xml(config.lease_s, config.log_level)},{uri}"


def _parts(uri: str) -> list[str]:
    """Split a configuration URI at its commas, those inside XML left alone."""
    if not uri.isascii():
        raise ConfigurationError(f"{URI} holds characters outside ASCII: {uri!r}")
    found: list[str] = []
    for part in re.split(r"(?<=>)\s*,\s*", uri):
        found += [part] if part.lstrip().startswith("<") else part.split(",")
    return [part.strip() for part in found if part.strip()]


def _check_user_xml(part: str) -> None:
    """Refuse what the library would pass over (broken XML) or die of (peers without address)."""
    where = URI
    text = part
    if not part.startswith("<"):
        where = part.removeprefix("file://")
        try:
            text = Path(where).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as problem:
            raise ConfigurationError(f"{URI}: cannot read {where}: {problem}") from None
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as problem:
        line, column = problem.position
        what = str(problem).partition(":")[0]
        raise ConfigurationError(f"{where}:{line}:{column + 1}: not XML: {what}") from None
    for element in root.iter():
        if element.tag.rpartition("}")[2].lower() == "peer":
            check_peer(element.get("Address") or element.get("address") or "")


def _start(domain_id: int, xml: str) -> tuple[Domain, frozenset[int]]:
    """Start the library's domain; also the interfaces that its sockets were closed to all but."""
    try:
        with opened_sockets() as opened, captured_stderr() as said:
            domain = Domain(domain_id, xml)
    except DDSException as problem:
        raise ConfigurationError(_explain(domain_id, said.cause or str(problem))) from None
    try:
        return domain, _close_to_others(opened)
    except DdsError:
        binding.delete(domain)
        raise


def _close_to_others(opened: Sockets) -> frozenset[int]:
    interfaces = opened.interfaces()
    opened.receive_only_from(interfaces)
    return interfaces


def _explain(domain_id: int, cause: str) -> str:
    hints = {
        "receive buffer": "allow more with: sysctl -w net.core.rmem_max=BYTES",
        "available interface": "choose an interface that exists, is up and has an IPv4 address",
        "participant index": "too many participants of this domain run on this machine",
        "unknown element": f"correct the XML in {URI}",
    }
    hint = next((f"; {text}" for word, text in hints.items() if word in cause), "")
    return f"DDS domain {domain_id} cannot start: {cause}{hint}"
