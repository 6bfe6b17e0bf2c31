"""CycloneDDS configuration from a few named settings, checked before the library sees it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, fields
from difflib import get_close_matches
from typing import Any, Literal
from xml.sax.saxutils import quoteattr

from safety_island.dds.network import LOOPBACK, check_interface, check_peer
from safety_island.errors import ConfigurationError

MAX_DOMAIN_ID = 232
"""The highest domain id whose ports fit into 16 bits (RTPS 2.5, section 9.6.2.3)."""
URI = "CYCLONEDDS_URI"

Multicast = Literal["spdp", "off", "full"]
_ALLOW_MULTICAST = {"spdp": "spdp", "off": "false", "full": "true"}
_MESSAGE_OVERHEAD = 56
"""Bytes of an RTPS message around one fragment: 1400 leaves the usual 1344."""
_MESSAGE_SIZES = (576, 65500)
_ANNOUNCEMENTS_PER_LEASE = 3
_VERBOSITIES = ("none", "config", "finest")


@dataclass(frozen=True)
class DdsConfig:
    """How DDS uses the network.

    ``interface`` is a network interface by name (None: the library chooses); ``loopback_only``
    stays on this machine and needs no multicast; ``peers`` are hosts to announce to directly;
    ``multicast`` is ``spdp`` (discovery only), ``off`` or ``full``; ``max_message_size`` [B] must
    fit the network's MTU; ``receive_buffer`` [B] is the least size of the socket's buffer;
    ``lease_s`` [s] is the time after which others miss this process; ``domain_tag`` keeps apart
    what shares a domain id; ``loss`` is the share of sent packets to drop (0 to 1, for tests);
    ``log_level`` is what the library tells on standard error (0 nothing, 1 warnings and its
    configuration, 2 everything).
    ConfigurationError for every value that cannot work.
    """

    interface: str | None = None
    loopback_only: bool = False
    peers: tuple[str, ...] = ()
    multicast: Multicast = "spdp"
    max_message_size: int = 1400
    receive_buffer: int | None = None
    lease_s: float = 1.0
    domain_tag: str = ""
    loss: float = 0.0
    log_level: int = 0

    def __post_init__(self) -> None:
        """Check what can be checked without the network."""
        _range("max_message_size", self.max_message_size, *_MESSAGE_SIZES, unit="bytes")
        _range("lease_s", self.lease_s, 0.1, 60.0, unit="s")
        _range("loss", self.loss, 0.0, 1.0)
        _range("log_level", self.log_level, 0, len(_VERBOSITIES) - 1)
        if self.receive_buffer is not None:
            _range("receive_buffer", self.receive_buffer, 4096, 2**30, unit="bytes")
        if self.multicast not in _ALLOW_MULTICAST:
            allowed = ", ".join(_ALLOW_MULTICAST)
            raise ConfigurationError(f"multicast is {self.multicast!r}, expected one of {allowed}")
        if self.loopback_only and self.interface not in (None, LOOPBACK):
            raise ConfigurationError(
                f"loopback_only and interface {self.interface!r} contradict each other; drop one"
            )

    @classmethod
    def from_mapping(cls, settings: Mapping[str, Any], source: str = "settings") -> DdsConfig:
        """Return the configuration of named settings; an unknown name is an error with a hint."""
        known = [field.name for field in fields(cls)]
        for name in settings:
            if name not in known:
                near = get_close_matches(name, known, n=1)
                hint = f"did you mean {near[0]}?" if near else f"known are {', '.join(known)}"
                raise ConfigurationError(f"{source}: unknown DDS setting {name!r}; {hint}")
        values = dict(settings)
        if "peers" in values:
            values["peers"] = tuple(values["peers"])
        return cls(**values)

    def check_network(self) -> None:
        """Raise ConfigurationError for an interface or a peer that this machine does not know."""
        if self._interface:
            check_interface(self._interface)
        for peer in self.peers:
            check_peer(peer)

    def xml(self, domain_id: int) -> str:
        """Return the CycloneDDS configuration of one domain."""
        check_domain_id(domain_id)
        general = self._interfaces() + _element("AllowMulticast", self._allow_multicast())
        general += _element("MaxMessageSize", f"{self.max_message_size}B")
        general += _element("FragmentSize", f"{self.max_message_size - _MESSAGE_OVERHEAD}B")
        domain = _element("General", general) + _element("Discovery", self._discovery(domain_id))
        domain += _COMPATIBILITY + _element("Internal", self._internal())
        return _document(domain + _tracing(self.log_level))

    @property
    def _interface(self) -> str | None:
        return LOOPBACK if self.loopback_only else self.interface

    def _interfaces(self) -> str:
        if self._interface is None:
            return ""
        return f"<Interfaces><NetworkInterface name={quoteattr(self._interface)}/></Interfaces>"

    def _allow_multicast(self) -> str:
        return "false" if self._interface == LOOPBACK else _ALLOW_MULTICAST[self.multicast]

    def _discovery(self, domain_id: int) -> str:
        """Unicast discovery needs well-known ports, hence a participant index; multicast none."""
        unicast = bool(self.peers) or self._allow_multicast() == "false"
        found = _element("ParticipantIndex", "auto" if unicast else "none")
        found += _element("MaxAutoParticipantIndex", str(max_participant_index(domain_id)))
        if self.peers:
            peers = [f'<Peer Address={quoteattr(p)} PruneDelay="inf"/>' for p in self.peers]
            found += _element("Peers", "".join(peers))
        return found + _lease(self.lease_s) + _element("Tag", _escape(self.domain_tag))

    def _internal(self) -> str:
        found = ""
        if self.receive_buffer is not None:
            found += f'<SocketReceiveBufferSize min="{self.receive_buffer}B"/>'
        if self.loss:
            found += _element("Test", _element("XmitLossiness", str(round(self.loss * 1000))))
        return found


def max_participant_index(domain_id: int) -> int:
    """Return the highest participant index whose ports fit into 16 bits (at most 99)."""
    return min(99, (65535 - 7400 - 250 * domain_id - 11) // 2)


def check_domain_id(domain_id: int) -> None:
    """Raise ConfigurationError unless the domain id is one that RTPS has ports for."""
    if not 0 <= domain_id <= MAX_DOMAIN_ID:
        raise ConfigurationError(
            f"domain id {domain_id} is out of range, expected 0 to {MAX_DOMAIN_ID}"
        )


def user_xml() -> str | None:
    """Return the user's own configuration (``CYCLONEDDS_URI``), None when there is none."""
    return os.environ.get(URI) or None


def defaults_xml(lease_s: float = 1.0, log_level: int = 0) -> str:
    """Return what a user's own XML is laid over: what peers need to match, and what is told."""
    discovery = _element("Discovery", _lease(lease_s))
    return _document(_COMPATIBILITY + discovery + _tracing(log_level))


def _tracing(log_level: int) -> str:
    if not log_level:
        return ""
    verbosity = _element("Verbosity", _VERBOSITIES[log_level])
    return _element("Tracing", verbosity + _element("OutputFile", "stderr"))


def _lease(lease_s: float) -> str:
    interval = lease_s / _ANNOUNCEMENTS_PER_LEASE
    return _element("LeaseDuration", f"{lease_s * 1000:.0f}ms") + _element(
        "SPDPInterval", f"{interval * 1000:.0f}ms"
    )


def _document(domain: str) -> str:
    return f'<CycloneDDS><Domain Id="any">{domain}</Domain></CycloneDDS>'


def _element(name: str, content: str) -> str:
    return f"<{name}>{content}</{name}>" if content else ""


def _escape(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")


def _range(name: str, value: float, low: float, high: float, unit: str = "") -> None:
    if not low <= value <= high:
        limits = f"{low:g} to {high:g} {unit}".rstrip()
        raise ConfigurationError(f"{name} is {value:g}, expected {limits}")


_COMPATIBILITY = _element("Compatibility", _element("IgnoreTypeInformation", "1.15"))
"""Fast DDS 3 (ROS 2 Kilted) announces type information that the library cannot match with ours."""

__all__ = ["DdsConfig", "check_domain_id", "check_interface", "defaults_xml", "user_xml"]
