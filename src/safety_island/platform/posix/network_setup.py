# SPDX-License-Identifier: Apache-2.0
"""Static addresses, VLANs and default routes, set over netlink with pyroute2.

What is set stays when the process ends, as with the ``ip`` command.
"""

from __future__ import annotations

import errno
import os
from ipaddress import IPv4Address, IPv4Interface
from typing import Any

from safety_island.platform.interfaces import NetworkError
from safety_island.platform.posix.network import LONGEST_NAME

_AF_INET = 2
_MAIN_TABLE = 254


def configure(
    interface: str, vlan: int, address: IPv4Interface | None, gateway: IPv4Address | None
) -> str:
    """Bring up the interface, or the VLAN of it, and give it what is configured.

    Returns its name. Raises NetworkError with what could not be done and why.
    """
    from pyroute2 import IPRoute
    from pyroute2.netlink.exceptions import NetlinkError

    name = f"{interface}.{vlan}" if vlan else interface
    doing = ""
    try:
        with IPRoute() as route:
            doing = "be brought up"
            index = _bring_up(route, interface)
            if vlan:
                doing = f"get VLAN {vlan}"
                index = _vlan(route, index, name, vlan)
            if address is not None:
                doing = f"get the address {address}"
                _add_address(route, index, address)
            if gateway is not None:
                doing = f"get the gateway {gateway}"
                _add_gateway(route, index, gateway)
    except (NetlinkError, OSError) as error:
        raise NetworkError(f"interface '{interface}' cannot {doing}: {_reason(error)}") from error
    return name


def _reason(error: Any) -> str:
    """Return the words for an error of the kernel; pyroute2 numbers it ``code``."""
    number = getattr(error, "code", None) or error.errno or 0
    if number in (errno.EPERM, errno.EACCES):
        return "it needs the right CAP_NET_ADMIN; run as root, or configure it by other means"
    if number == errno.EOPNOTSUPP:
        return "the kernel of this machine has no such thing (for a VLAN: module 8021q)"
    return os.strerror(abs(number))


def _bring_up(route: Any, name: str) -> int:
    """Return the index of the interface, which is up afterwards."""
    (index,) = route.link_lookup(ifname=name)
    (link,) = route.get_links(index)
    if not link["flags"] & 1:
        route.link("set", index=index, state="up")
    return int(index)


def _vlan(route: Any, parent: int, name: str, vlan: int) -> int:
    """Return the index of a VLAN of an interface, made when it is missing."""
    if len(name) > LONGEST_NAME:
        raise NetworkError(f"VLAN '{name}': a name has at most {LONGEST_NAME} characters")
    if found := route.link_lookup(ifname=name):
        (link,) = route.get_links(found[0])
        info = link.get_nested("IFLA_LINKINFO", "IFLA_INFO_DATA", "IFLA_VLAN_ID")
        if (info, link.get_attr("IFLA_LINK")) != (vlan, parent):
            raise NetworkError(f"interface '{name}' is there and is not VLAN {vlan}: remove it")
    else:
        route.link("add", ifname=name, kind="vlan", link=parent, vlan_id=vlan)
    return _bring_up(route, name)


def _add_address(route: Any, index: int, address: IPv4Interface) -> None:
    wanted = (str(address.ip), address.network.prefixlen)
    for item in route.get_addr(family=_AF_INET, index=index):
        if (item.get_attr("IFA_LOCAL"), item["prefixlen"]) == wanted:
            return
    route.addr("add", index=index, address=wanted[0], prefixlen=wanted[1])


def _add_gateway(route: Any, index: int, gateway: IPv4Address) -> None:
    """Add a default route; one that another has is not taken away."""
    for item in route.get_default_routes(family=_AF_INET, table=_MAIN_TABLE):
        found = (item.get_attr("RTA_GATEWAY"), item.get_attr("RTA_OIF"))
        if found == (str(gateway), index):
            return
        raise NetworkError(
            f"the machine has a default route already, over {found[0] or 'a link'}: "
            f"remove it, or configure no gateway (expected {gateway})"
        )
    route.route("add", dst="default", gateway=str(gateway), oif=index)
