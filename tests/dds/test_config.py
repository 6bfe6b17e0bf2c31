# SPDX-License-Identifier: Apache-2.0
"""Configuration: what each setting becomes, and one clear line for every mistake."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import pytest

from safety_island.dds import domain, network
from safety_island.dds.config import (
    MAX_DOMAIN_ID,
    URI,
    DdsConfig,
    defaults_xml,
    max_participant_index,
)
from safety_island.dds.participant import Participant
from safety_island.errors import ConfigurationError
from tests.dds.conftest import LOOPBACK


def domain_xml(config: DdsConfig, domain_id: int = 2) -> ElementTree.Element:
    found = ElementTree.fromstring(config.xml(domain_id)).find("Domain")
    assert found is not None
    return found


def text(config: DdsConfig, path: str, domain_id: int = 2) -> str | None:
    return domain_xml(config, domain_id).findtext(path)


def test_loopback_announces_by_multicast_and_to_the_usual_ports() -> None:
    """Peers of other versions and settings use the one or the other there."""
    found = domain_xml(LOOPBACK)
    (interface,) = found.iter("NetworkInterface")
    assert interface.attrib == {"name": "lo"}
    assert found.findtext("General/AllowMulticast") == "spdp"
    assert found.findtext("Discovery/ParticipantIndex") == "auto"
    (peers,) = found.iter("Peers")
    assert peers.attrib == {"AddLocalhost": "true"}


def test_interface_lo_is_loopback_whatever_the_multicast_mode() -> None:
    for multicast, allowed in (("full", "spdp"), ("off", "false")):
        config = DdsConfig(interface="lo", multicast=multicast)  # type: ignore[arg-type]
        assert text(config, "General/AllowMulticast") == allowed
        assert text(config, "Discovery/ParticipantIndex") == "auto"


def test_a_network_uses_multicast_for_discovery_only() -> None:
    config = DdsConfig(interface="tap0")
    assert text(config, "General/AllowMulticast") == "spdp"
    assert text(config, "Discovery/ParticipantIndex") == "none"
    assert text(config, "General/MaxMessageSize") == "1400B"
    assert text(config, "General/FragmentSize") == "1344B"


@pytest.mark.parametrize(
    ("mode", "allowed"), [("spdp", "spdp"), ("off", "false"), ("full", "true")]
)
def test_multicast_modes(mode: Any, allowed: str) -> None:
    assert text(DdsConfig(multicast=mode), "General/AllowMulticast") == allowed


def test_peers_need_known_ports_and_are_never_given_up() -> None:
    config = DdsConfig(peers=("192.0.2.7", "192.0.2.8:7410"))
    peers = [peer.attrib for peer in domain_xml(config).iter("Peer")]
    assert peers == [
        {"Address": "192.0.2.7", "PruneDelay": "inf"},
        {"Address": "192.0.2.8:7410", "PruneDelay": "inf"},
    ]
    assert text(config, "Discovery/ParticipantIndex") == "auto"


def test_kilted_is_matched_and_deaths_are_noticed_by_default() -> None:
    assert text(DdsConfig(), "Compatibility/IgnoreTypeInformation") == "1.15"
    assert text(DdsConfig(), "Discovery/LeaseDuration") == "1000ms"
    assert text(DdsConfig(), "Discovery/SPDPInterval") == "333ms"


def test_peers_of_old_versions_see_what_is_closed_and_whose_it_is() -> None:
    for xml in (DdsConfig().xml(2), defaults_xml()):
        found = ElementTree.fromstring(xml)
        assert found.findtext("Domain/Internal/GenerateKeyhash") == "true"
        assert found.findtext("Domain/Compatibility/ExplicitlyPublishQosSetToDefault") == "true"


def test_a_list_of_peers_is_taken_apart() -> None:
    config = DdsConfig(peers=("192.0.2.7, udp/192.0.2.8:7410", "lead.example"))
    assert config.peers == ("192.0.2.7", "udp/192.0.2.8:7410", "lead.example")
    assert text(config, "General/Transport") is None


def test_peers_of_ipv6_use_udp_over_ipv6() -> None:
    config = DdsConfig(interface="eth0", peers=("fc94::3", "[fc94::4]:7410"))
    assert text(config, "General/Transport") == "udp6"
    with pytest.raises(ConfigurationError, match="expected all of IPv6 or all of IPv4"):
        DdsConfig(peers=("fc94::3", "192.0.2.7")).xml(2)


def test_a_tag_may_be_that_of_one_domain() -> None:
    config = DdsConfig(domain_tags=((2, "vehicle-7"),))
    assert text(config, "Discovery/Tag", 1) is None
    assert text(config, "Discovery/Tag", 2) == "vehicle-7"


@pytest.mark.parametrize("tag", ["a" * 256, "a\nb", "l\u00f6"])
def test_a_tag_that_cannot_be_sent_is_refused(tag: str) -> None:
    with pytest.raises(ConfigurationError, match="expected at most 255 printable ASCII"):
        DdsConfig(domain_tag=tag)
    with pytest.raises(ConfigurationError, match="expected at most 255 printable ASCII"):
        DdsConfig(domain_tags=((2, tag),))


def test_row_96_an_interface_without_multicast_is_told_when_no_peer_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(network, "flags", {"wg0": 0x91, "eth0": 0x1003, "lo": 0x9}.get)
    said = DdsConfig(interface="wg0").warning()
    assert said is not None and "'wg0' carries no multicast" in said and "--peer ADDRESS" in said
    assert DdsConfig(interface="wg0", peers=("10.0.0.2",)).warning() is None
    assert DdsConfig(interface="eth0").warning() is None
    assert LOOPBACK.warning() is None
    assert text(DdsConfig(interface="wg0"), "Discovery/ParticipantIndex") == "auto"
    assert text(DdsConfig(interface="eth0"), "Discovery/ParticipantIndex") == "none"


def test_the_kernel_tells_the_flags_of_an_interface() -> None:
    assert network.flags("lo") & 0x9 == 0x9
    assert network.flags("nowhere9") == 0x1001


def test_the_other_settings() -> None:
    config = DdsConfig(receive_buffer=2**20, domain_tag="a<b&c", loss=0.2, max_message_size=9000)
    (buffer,) = domain_xml(config).iter("SocketReceiveBufferSize")
    assert buffer.attrib == {"min": "1048576B"}
    assert text(config, "Discovery/Tag") == "a<b&c"
    assert text(config, "Internal/Test/XmitLossiness") == "200"
    assert text(config, "General/FragmentSize") == "8944B"
    (internal,) = domain_xml(DdsConfig()).iter("Internal")
    assert [element.tag for element in internal] == ["GenerateKeyhash"]


def test_ports_of_every_participant_index_fit_into_16_bits() -> None:
    assert max_participant_index(0) == max_participant_index(200) == 99
    assert max_participant_index(MAX_DOMAIN_ID) == 62
    for domain_id in range(MAX_DOMAIN_ID + 1):
        index = max_participant_index(domain_id)
        assert 0 <= 7400 + 250 * domain_id + 11 + 2 * index <= 65535
        assert text(LOOPBACK, "Discovery/MaxAutoParticipantIndex", domain_id) == str(index)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"max_message_size": 100}, "max_message_size is 100, expected 576 to 65500 bytes"),
        ({"lease_s": 0.0}, "lease_s is 0, expected 0.1 to 60 s"),
        ({"loss": 1.5}, "loss is 1.5, expected 0 to 1"),
        ({"receive_buffer": 1}, "receive_buffer is 1, expected 4096 to"),
        ({"multicast": "sdpd"}, "multicast is 'sdpd', expected one of spdp, off, full"),
        ({"loopback_only": True, "interface": "eth0"}, "contradict each other"),
        ({"interfase": "lo"}, "unknown DDS setting 'interfase'; did you mean 'interface'?"),
        ({"xyz": 1}, "unknown DDS setting 'xyz'; known are interface, loopback_only"),
    ],
)
def test_a_setting_that_cannot_work_is_refused(settings: dict[str, Any], said: str) -> None:
    with pytest.raises(ConfigurationError) as refused:
        DdsConfig.from_mapping(settings)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_settings_from_a_file_may_hold_lists() -> None:
    assert DdsConfig.from_mapping({"peers": ["192.0.2.1"]}) == DdsConfig(peers=("192.0.2.1",))


def refusal(domain_id: int, config: DdsConfig = LOOPBACK) -> str:
    with pytest.raises(ConfigurationError) as refused, Participant(domain_id, config):
        raise AssertionError("a participant came up")
    said = str(refused.value)
    assert "\n" not in said
    assert refused.value.exit_code == 2
    return said


@pytest.mark.parametrize("domain_id", [-1, 233, 5000])
def test_a_domain_id_out_of_range_is_refused(domain_id: int) -> None:
    assert refusal(domain_id) == f"domain id {domain_id} is out of range, expected 0 to 232"


def test_a_wrong_interface_is_told_with_those_that_exist(
    domain_id: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(network, "interfaces", lambda: ["lo", "tap1"])
    said = refusal(domain_id, DdsConfig(interface="tap0"))
    assert said.startswith("network interface 'tap0' does not exist; this machine has lo, tap1")
    assert "did you mean 'tap1'?" in said


def test_an_interface_that_is_down_is_told(domain_id: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(network, "flags", {"lo": 0x8}.get)
    assert "network interface 'lo' is down; run: ip link set lo up" in refusal(domain_id)


@pytest.mark.parametrize("peer", ["no-such-host.invalid", "", "127.0.0.1:0", "127.0.0.1:http"])
def test_a_peer_that_does_not_resolve_is_told(peer: str, domain_id: int) -> None:
    """The library would end the process without a word in Python."""
    said = refusal(domain_id, DdsConfig(loopback_only=True, peers=(peer,)))
    assert f"DDS peer {peer!r} cannot be resolved" in said


@pytest.mark.parametrize("peer", ["192.0.2.7", "udp/192.0.2.7:7410", "fc94::3", "[fc94::3]:7410"])
def test_a_peer_elsewhere_is_no_use_on_loopback(peer: str, domain_id: int) -> None:
    said = refusal(domain_id, DdsConfig(interface="lo", peers=(peer,)))
    assert f"DDS peer {peer!r} is another machine" in said and "--interface" in said


@pytest.mark.parametrize("peer", ["localhost", "127.0.0.1", "udp/127.0.0.1:7411", "239.255.0.2"])
def test_every_form_of_a_peer_that_the_library_takes_is_taken(peer: str, domain_id: int) -> None:
    with Participant(domain_id, DdsConfig(loopback_only=True, peers=(peer, peer))) as own:
        assert own.guid


def test_a_peer_that_crashes_the_library_is_told(domain_id: int) -> None:
    said = refusal(domain_id, DdsConfig(peers=("0.0.0.0",)))
    assert f"DDS domain {domain_id} cannot start: the library ends with SIG" in said


def test_a_receive_buffer_beyond_the_kernel_s_limit_is_told(domain_id: int) -> None:
    said = refusal(domain_id, DdsConfig(loopback_only=True, receive_buffer=2**30))
    assert f"DDS domain {domain_id} cannot start: failed to increase socket receive buffer" in said
    assert "sysctl -w net.core.rmem_max" in said


GOOD_XML = """<CycloneDDS><Domain><General>
  <Interfaces><NetworkInterface name="lo"/></Interfaces><AllowMulticast>false</AllowMulticast>
</General></Domain></CycloneDDS>"""


def test_the_user_s_own_xml_wins(
    domain_id: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The settings name an interface that does not exist; the XML does not."""
    wrong = DdsConfig(interface="tap77")
    path = tmp_path / "cyclonedds.xml"
    path.write_text(GOOD_XML)
    more = tmp_path / "more.xml"
    more.write_text("<CycloneDDS><Domain><Discovery/></Domain></CycloneDDS>")
    for uri in (GOOD_XML, str(path), f"file://{path}", f"{GOOD_XML},{more}", f"{more},{path}"):
        monkeypatch.setenv(URI, uri)
        with Participant(domain_id, wrong) as own:
            assert own.publisher("/a", "std_msgs/msg/Header").matched() == 0
    monkeypatch.delenv(URI)
    assert "tap77" in refusal(domain_id, wrong)


SHORT = '<Gen><Interfaces><Netw n="lo"/></><Al>spdp,asm</></>'


@pytest.mark.parametrize(
    "uri",
    [
        SHORT,
        f"{SHORT},<Disc><LeaseD>2s</></>",
        "<Disc><Peers><Peer addr='udp/127.0.0.1:7410,localhost'/></></>",
        "<CycloneDDS><!-- </> --><Domain Id='any'><Gen><Interfaces><N n='lo'/></></></></>",
    ],
)
def test_the_short_form_of_the_xml_is_taken(
    uri: str, domain_id: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(URI, uri)
    with Participant(domain_id) as own:
        assert own.guid


def test_a_tag_and_peers_of_the_command_line_hold_over_the_user_s_xml(
    domain_id: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(URI, f"{GOOD_XML},<Disc><Tag>other</></>")
    tagged = DdsConfig(domain_tag="vehicle-7", peers=("127.0.0.1",))
    assert domain._effective_xml(domain_id, tagged).endswith(
        '<Discovery><Tag>vehicle-7</Tag><Peers><Peer Address="127.0.0.1" PruneDelay="inf"/></Peers>'
        "</Discovery></Domain></CycloneDDS>"
    )
    with Participant(domain_id, tagged) as own:
        assert own.guid


@pytest.mark.parametrize(
    ("xml", "said"),
    [
        (SHORT + SHORT, "not XML: junk after document element"),
        (SHORT.removesuffix("</>"), f"{URI}:1:62: not XML: no element found"),
        ("<Gen><Al>perhaps</></>", "'perhaps' in 'perhaps' undefined"),
        (GOOD_XML.replace("General>", "Generale>"), "Generale: unknown element"),
        (GOOD_XML.replace('"lo"', '"tap0"'), "tap0: does not match an available interface"),
        (GOOD_XML.replace("false", "perhaps"), "'perhaps' in 'perhaps' undefined"),
        (GOOD_XML.removesuffix("</CycloneDDS>"), f"{URI}:3:20: not XML: no element found"),
        (GOOD_XML.replace('"lo"', '"l\u00f6"'), "characters outside ASCII"),
        (
            GOOD_XML.replace(
                "</Domain>",
                '<Discovery><Peers><Peer Address="a.invalid"/></Peers></Discovery></Domain>',
            ),
            "DDS peer 'a.invalid' cannot be resolved",
        ),
        ("/no/such/file.xml", f"{URI}: cannot read /no/such/file.xml"),
    ],
)
def test_a_mistake_in_the_user_s_xml_is_one_line(
    xml: str,
    said: str,
    domain_id: int,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv(URI, xml)
    assert said in refusal(domain_id)
    assert capfd.readouterr() == ("", "")


def test_a_mistake_in_a_file_names_the_file(
    domain_id: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    path = tmp_path / "own.xml"
    path.write_text("<CycloneDDS>\n<Domain>\n")
    monkeypatch.setenv(URI, f"file://{path}")
    assert f"{path}:3:1: not XML" in refusal(domain_id)


def test_a_warning_of_the_library_still_reaches_the_user(
    domain_id: int, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    deprecated = GOOD_XML.replace(
        "</General>", "</General><Discovery><LeaseDuration>1</LeaseDuration></Discovery>"
    )
    monkeypatch.setenv(URI, deprecated)
    with Participant(domain_id):
        pass
    assert "use of default unit is deprecated" in capfd.readouterr().err


def test_one_domain_has_one_configuration_in_a_process(domain_id: int) -> None:
    with Participant(domain_id, LOOPBACK), Participant(domain_id, LOOPBACK):
        said = refusal(domain_id, DdsConfig(loopback_only=True, max_message_size=9000))
    assert f"domain {domain_id} is already open in this process with another configuration" in said
    with Participant(domain_id, DdsConfig(loopback_only=True, max_message_size=9000)):
        pass


def test_too_many_participants_are_told(domain_id: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """One index for a domain whose only index another process holds."""
    import socket

    from safety_island.dds import config

    monkeypatch.setattr(config, "max_participant_index", lambda _: 0)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 7400 + 250 * domain_id + 10))
        said = refusal(domain_id)
    assert "free participant index" in said and "too many participants" in said


def test_domain_tags_keep_participants_apart(domain_id: int) -> None:
    """Row 79: a peer with another tag is never matched; the same process shares one domain."""
    assert text(DdsConfig(domain_tag="vehicle-7"), "Discovery/Tag") == "vehicle-7"
    with Participant(domain_id, DdsConfig(loopback_only=True, domain_tag="vehicle-7")) as own:
        assert own.guid
