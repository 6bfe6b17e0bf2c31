# SPDX-License-Identifier: Apache-2.0
"""DDS domains of this process: one library object for each id, shared by its participants."""

from __future__ import annotations

import re
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from safety_island.dds.config import DdsConfig, check_domain_id, defaults_xml
from safety_island.dds.errors import DdsError
from safety_island.dds.follow import InterfaceSockets, follow
from safety_island.dds.library.entity import checked, delete
from safety_island.dds.library.loading import choose, loaded
from safety_island.dds.network import unknown_peer
from safety_island.dds.receive_filter import opened_sockets
from safety_island.dds.stderr import captured_log
from safety_island.dds.trial import BAD_PEER, why_fatal
from safety_island.dds.user_xml import URI, check_user_xml, user_xml
from safety_island.errors import ConfigurationError


@dataclass
class _Open:
    domain: int
    sockets: InterfaceSockets
    xml: str
    users: int


_lock = threading.Lock()
_open: dict[int, _Open] = {}


def open_domain(domain_id: int, config: DdsConfig) -> None:
    """Start a domain, or share the one that this process has under the same configuration.

    Raises ConfigurationError with the library's own words when it refuses the configuration.
    """
    check_domain_id(domain_id)
    if config.library is not None:
        choose(config.library)
    xml = _effective_xml(domain_id, config)
    with _lock:
        found = _open.get(domain_id)
        if found is None:
            _open[domain_id] = _Open(*_start(domain_id, xml), xml, 1)
            follow(_look_at_interfaces)
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
        _open[domain_id].sockets.add(opened)


def close_domain(domain_id: int) -> None:
    """Give a domain back; the last one to do so ends it."""
    with _lock:
        found = _open[domain_id]
        found.users -= 1
        if not found.users:
            del _open[domain_id]
            delete(found.domain)


def must_rejoin() -> bool:
    """Whether a domain has to be left and joined anew, since its address is another one now."""
    return any(found.sockets.has_moved for found in list(_open.values()))


def _effective_xml(domain_id: int, config: DdsConfig) -> str:
    """Return what the library gets: our settings, or the user's own laid over our defaults."""
    uri, release = user_xml(), loaded().release
    if uri is not None:
        check_user_xml(uri)
        over = config.overlay_xml(domain_id, release)
        xml = f"{defaults_xml(config.lease_s, config.log_level, release)},{uri},{over}"
    else:
        config.check_network()
        xml = config.xml(domain_id, release)
        if warning := config.warning():
            print(f"island: warning: {warning}", file=sys.stderr, flush=True)
    if (uri or config.peers) and (fatal := why_fatal(domain_id, xml)):
        raise ConfigurationError(_explain(domain_id, fatal))
    return xml


def _look_at_interfaces() -> None:
    """Follow the interfaces of all domains after a change, and say what changed."""
    with _lock:
        for domain_id, found in _open.items():
            try:
                lines = list(found.sockets.update())
            except DdsError as problem:
                lines = [str(problem)]
            for line in lines:
                print(f"island: DDS domain {domain_id}: {line}", file=sys.stderr, flush=True)


def _start(domain_id: int, xml: str) -> tuple[int, InterfaceSockets]:
    """Start the library's domain, and close its sockets to all interfaces but those it uses."""
    with opened_sockets() as opened:
        domain = _create(domain_id, xml)
    try:
        return domain, InterfaceSockets(opened)
    except DdsError:
        delete(domain)
        raise


def _create(domain_id: int, xml: str) -> int:
    """Return the library's domain. Raises ConfigurationError with its own words."""
    library = loaded()
    try:
        with captured_log(bool(_TRACING.search(xml))) as said:
            return checked(library.dds_create_domain(domain_id, xml.encode()), "refused")
    except DdsError as problem:
        raise ConfigurationError(_explain(domain_id, said.cause or str(problem))) from None


def _explain(domain_id: int, cause: str) -> str:
    if peer := BAD_PEER.search(cause):
        return unknown_peer(peer[1])
    hints = {
        "receive buffer": "allow more with: sysctl -w net.core.rmem_max=BYTES",
        "available interface": "choose an interface that exists, is up and has an address",
        "participant index": "too many participants of this domain run on this machine",
        "unknown element": f"correct the XML in {URI}",
    }
    hint = next((f"; {text}" for word, text in hints.items() if word in cause), "")
    return f"DDS domain {domain_id} cannot start: {cause}{hint}"


_TRACING = re.compile(r"<tr", re.IGNORECASE)
"""The library's trace is on: it is for the user to read as it is."""
