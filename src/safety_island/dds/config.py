# SPDX-License-Identifier: Apache-2.0
"""CycloneDDS configuration from a few named settings, checked before the library sees it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal
from xml.sax.saxutils import quoteattr

from safety_island.dds.library.release import Release
from safety_island.dds.network import (
    LOOPBACK,
    check_interface,
    has_multicast,
    is_elsewhere,
    unknown_peer,
)
from safety_island.dds.user_xml import URI, user_xml
from safety_island.errors import ConfigurationError
from safety_island.words import did_you_mean

MAX_DOMAIN_ID = 232
"""The highest domain id whose ports fit into 16 bits (RTPS 2.5, section 9.6.2.3)."""

Multicast = Literal["spdp", "off", "full"]
_ALLOW_MULTICAST = {"spdp": "spdp", "off": "false", "full": "true"}
_MESSAGE_OVERHEAD = 56
"""Bytes of an RTPS message around one fragment: 1400 leaves the usual 1344."""
_MESSAGE_SIZES = (576, 65500)
_ANNOUNCEMENTS_PER_LEASE = 3
_LONGEST_TAG = 255
"""RTPS 2.5, section 9.6.2.2.1: a string of less than 256 characters."""
_VERBOSITIES = ("none", "config", "finest")


@dataclass(frozen=True)
class DdsConfig:
    """How DDS uses the network.

    ``interface`` is a network interface by name (None: the library chooses); ``loopback_only``
    stays on this machine; ``peers`` are hosts to announce to directly, as the library takes them
    (address or name, with an optional port); ``multicast`` is ``spdp`` (discovery only), ``off`` or
    ``full``; ``max_message_size`` [B] must fit the network's MTU;
    ``receive_buffer`` [B] is the least size of the socket's buffer; ``lease_s`` [s] is the time
    after which others miss this process; ``domain_tag`` keeps apart what shares a domain id, and
    ``domain_tags`` are those of single domains, in its place; ``loss`` is the share of sent packets
    to drop (0 to 1, for tests); ``log_level`` is what the library tells on standard error (0
    nothing, 1 warnings and its configuration, 2 everything); ``library`` is CycloneDDS's C library
    or its folder (None: the first that is found).
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
    domain_tags: tuple[tuple[int, str], ...] = ()
    loss: float = 0.0
    log_level: int = 0
    library: Path | None = None

    def __post_init__(self) -> None:
        """Check what can be checked without the network."""
        _range("max_message_size", self.max_message_size, *_MESSAGE_SIZES, unit="bytes")
        _range("lease_s", self.lease_s, 0.1, 60.0, unit="s")
        _range("loss", self.loss, 0.0, 1.0)
        _range("log_level", self.log_level, 0, len(_VERBOSITIES) - 1)
        if self.receive_buffer is not None:
            _range("receive_buffer", self.receive_buffer, 4096, 2**30, unit="bytes")
        for tag in (self.domain_tag, *(tag for _, tag in self.domain_tags)):
            _check_tag(tag)
        object.__setattr__(self, "peers", _split(self.peers))
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
                hint = did_you_mean(name, known) or f"; known are {', '.join(known)}"
                raise ConfigurationError(f"{source}: unknown DDS setting {name!r}{hint}")
        values = dict(settings)
        if "peers" in values:
            values["peers"] = tuple(values["peers"])
        return cls(**values)

    def check_network(self) -> None:
        """Raise ConfigurationError for an interface that this machine does not know."""
        if self._interface:
            check_interface(self._interface)
        if "" in self.peers:
            raise ConfigurationError(unknown_peer(""))
        if self._interface == LOOPBACK and (peer := next(filter(is_elsewhere, self.peers), None)):
            raise ConfigurationError(
                f"DDS peer {peer!r} is another machine, and interface 'lo' reaches this one only;"
                " name the interface that leads there with --interface"
            )

    def warning(self) -> str | None:
        """Say in one line why nobody may be found; None when there is no such reason."""
        if self._interface is None or self.peers or has_multicast(self._interface):
            return None
        return (
            f"network interface {self._interface!r} carries no multicast, so discovery finds"
            " nobody there; name the other machines with --peer ADDRESS, on both sides"
        )

    def xml(self, domain_id: int, release: Release = Release.V11) -> str:
        """Return the CycloneDDS configuration of one domain, in elements of that release."""
        check_domain_id(domain_id)
        general = self._interfaces(release) + self._transport()
        general += _element("AllowMulticast", self._allow_multicast())
        general += _element("MaxMessageSize", f"{self.max_message_size}B")
        general += _element("FragmentSize", f"{self.max_message_size - _MESSAGE_OVERHEAD}B")
        discovery = self._discovery(domain_id, release)
        domain = _element("General", general) + _element("Discovery", discovery)
        domain += _compatibility(release) + _element("Internal", self._internal())
        return _document(domain + _tracing(self.log_level))

    @property
    def _interface(self) -> str | None:
        return LOOPBACK if self.loopback_only else self.interface

    def _interfaces(self, release: Release) -> str:
        """Return the interface; loopback carries multicast, which release 0.10 does not know."""
        if self._interface is None:
            return ""
        forced = release is Release.V0_10 and self._interface == LOOPBACK
        multicast = ' multicast="true"' if forced else ""
        named = f"<NetworkInterface name={quoteattr(self._interface)}{multicast}/>"
        return _element("Interfaces", named)

    def _transport(self) -> str:
        """Return UDP over IPv6 when that is what the peers have."""
        return _element("Transport", "udp6" if _all_ipv6(self.peers) else "")

    def _allow_multicast(self) -> str:
        """On loopback for discovery only, at most: there is nothing to be gained for data."""
        allowed = _ALLOW_MULTICAST[self.multicast]
        return "spdp" if self._interface == LOOPBACK and allowed == "true" else allowed

    def _discovery(self, domain_id: int, release: Release) -> str:
        """Unicast discovery needs well-known ports, hence a participant index; multicast none.

        On loopback both: peers there use the one or the other, by their version and settings.
        """
        on_loopback = self._interface == LOOPBACK
        unicast = on_loopback or bool(self.peers) or not self._reaches_by_multicast()
        found = _element("ParticipantIndex", "auto" if unicast else "none")
        found += _element("MaxAutoParticipantIndex", str(max_participant_index(domain_id)))
        if not on_loopback:
            found += _element("Peers", self._peers(release))
        elif release is Release.V0_10:
            found += _element("Peers", _LOCALHOST + self._peers(release))
        else:
            found += f'<Peers AddLocalhost="true">{self._peers(release)}</Peers>'
        return found + _lease(self.lease_s) + self._tag(domain_id)

    def overlay_xml(self, domain_id: int, release: Release = Release.V11) -> str:
        """Return what is laid over a user's own XML: the settings that it was not to decide."""
        found = self._tag(domain_id)
        if self.peers:
            found += _element("Peers", self._peers(release))
        return _document(_element("Discovery", found)) if found else ""

    def peer_xml(self, domain_id: int) -> str:
        """Return the CycloneDDS configuration of a program that is to meet this one.

        In elements that CycloneDDS 0.10 knows as well.
        """
        check_domain_id(domain_id)
        general = self._interfaces(Release.V11) + self._transport()
        if self._interface == LOOPBACK:
            general += _element("AllowMulticast", self._allow_multicast())
            discovery = _element("ParticipantIndex", "auto") + _element(
                "MaxAutoParticipantIndex", str(max_participant_index(domain_id))
            )
            peers = ("127.0.0.1", *self.peers)
        else:
            general += _element("MaxMessageSize", f"{self.max_message_size}B")
            discovery = _element("ParticipantIndex", "auto" if self.peers else "")
            peers = self.peers
        found = "".join(f"<Peer Address={quoteattr(peer)}/>" for peer in peers)
        discovery += _element("Peers", found) + self._tag(domain_id)
        return _document(_element("General", general) + _element("Discovery", discovery))

    def tag(self, domain_id: int) -> str:
        """Return the tag of a domain, empty when it has none."""
        return dict(self.domain_tags).get(domain_id, self.domain_tag)

    def _tag(self, domain_id: int) -> str:
        return _element("Tag", _escape(self.tag(domain_id)))

    def _peers(self, release: Release) -> str:
        """Return the peers, never to be given up; release 0.10 gives none up by itself."""
        kept = "" if release is Release.V0_10 else ' PruneDelay="inf"'
        return "".join(f"<Peer Address={quoteattr(peer)}{kept}/>" for peer in self.peers)

    def _reaches_by_multicast(self) -> bool:
        if self._allow_multicast() == "false":
            return False
        return self._interface is None or has_multicast(self._interface)

    def _internal(self) -> str:
        found = _KEY_HASH
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


def defaults_xml(lease_s: float = 1.0, log_level: int = 0, release: Release = Release.V11) -> str:
    """Return what a user's own XML is laid over: what peers need to match, and what is told."""
    discovery = _element("Discovery", _lease(lease_s))
    internal = _element("Internal", _KEY_HASH)
    return _document(_compatibility(release) + discovery + internal + _tracing(log_level))


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


def _check_tag(tag: str) -> None:
    if len(tag) > _LONGEST_TAG or not (tag.isascii() and (tag.isprintable() or not tag)):
        raise ConfigurationError(
            f"domain tag {tag!r}: expected at most {_LONGEST_TAG} printable ASCII characters"
        )


def _split(peers: tuple[str, ...]) -> tuple[str, ...]:
    """Return each peer of lists with commas."""
    return tuple(peer.strip() for text in peers for peer in text.split(","))


def _all_ipv6(peers: tuple[str, ...]) -> bool:
    """Return whether the peers are IPv6 addresses. Raises ConfigurationError for a mixture."""
    ipv6 = [peer for peer in peers if peer.count(":") > 1]
    if ipv6 and len(ipv6) < len(peers):
        other = next(peer for peer in peers if peer not in ipv6)
        raise ConfigurationError(
            f"DDS peers {ipv6[0]!r} and {other!r}: expected all of IPv6 or all of IPv4, since one"
            " domain uses one of them"
        )
    return bool(ipv6)


def _compatibility(release: Release) -> str:
    """Return what peers with Fast DDS 3 (ROS 2 Kilted) need.

    They announce type information that release 11 cannot match with ours, and know history and
    depth of an endpoint only when they are sent, default or not.
    """
    ignored = "" if release is Release.V0_10 else _element("IgnoreTypeInformation", "1.15")
    sent = _element("ExplicitlyPublishQosSetToDefault", "true")
    return _element("Compatibility", ignored + sent)


_LOCALHOST = '<Peer Address="127.0.0.1"/>'
_KEY_HASH = _element("GenerateKeyhash", "true")
"""Without it Fast DDS and CycloneDDS 0.10 do not see that an endpoint is closed."""

__all__ = ["URI", "DdsConfig", "check_domain_id", "check_interface", "defaults_xml", "user_xml"]
