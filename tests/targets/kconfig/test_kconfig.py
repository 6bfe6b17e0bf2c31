# SPDX-License-Identifier: Apache-2.0
"""The merge of fragments: contract values, order, and what is refused, with its place."""

from pathlib import Path

import kconfiglib
import pytest

from safety_island.can.targets import TARGET_OUTPUT
from safety_island.errors import ConfigurationError
from safety_island.targets.kconfig.places import Places
from safety_island.targets.kconfig.resolve import Resolved, resolve
from safety_island.targets.kconfig.targets import NAMES, TARGETS, Target

CONTRACT = {
    "ENABLE_SNTP": False,
    "DDS_DOMAIN_ID": 2,
    "LOG_LEVEL": 1,
    "LOG_THROTTLE_RATE": 3,
    "DDS_LOG_LEVEL": 0,
    "THREAD_STACK_SIZE": 262144,
    "NET_DHCPV4_INITIAL_DELAY_MAX": 10,
    **{f"NET_IFACE{i}_{name}": "" for i in (1, 2) for name in ("ADDR", "GW", "NETMASK")},
    **{f"NET_IFACE{i}_VLAN": 0 for i in (1, 2)},
}
INTERFACES = {
    "fvp_baser_aemv8r_smp": "ethernet",
    "s32z270dc2_rtu0_r52@D": "ethernet@74b00000",
    "freertos_posix": "lo",
    "posix": "lo",
}


def write(places: Places, name: str, *lines: str) -> Path:
    path = places.config.parent / name
    path.write_text("".join(f"{line}\n" for line in lines))
    return path


def setting(found: Resolved, symbol: str) -> tuple[object, str]:
    (item,) = [item for item in found.settings if item.symbol == symbol]
    return item.value, item.origin


def mistakes(
    places: Places, *fragments: Path, overrides: tuple[str, ...] = (), target: str = "posix"
) -> list[str]:
    with pytest.raises(ConfigurationError) as raised:
        resolve(target, fragments, overrides, places)
    return str(raised.value).splitlines()


@pytest.mark.parametrize("target", NAMES)
def test_every_target_has_the_values_of_the_contract(target: str, places: Places) -> None:
    found = resolve(target, places=places)
    values = found.values()
    assert {name: values[name] for name in CONTRACT} == CONTRACT
    assert values["DDS_NETWORK_INTERFACE"] == INTERFACES[target]
    output = TARGET_OUTPUT[target]
    modes = ("DDS_ONLY", "CAN_ONLY", "DDS_AND_CAN")
    chosen = [mode for mode in modes if values[f"CONTROL_CMD_OUTPUT_{mode}"]]
    assert chosen == [output.mode.name]
    assert values["CONTROL_CMD_DDS_OUTPUT"] is output.mode.uses_dds
    assert values["CONTROL_CMD_CAN_OUTPUT"] is values["CAN"] is output.mode.uses_can
    assert values["CAN_DEVICE"] == (output.can or "")
    assert found.notes == ()


@pytest.mark.parametrize("mode", ["DDS_ONLY", "CAN_ONLY", "DDS_AND_CAN"])
@pytest.mark.parametrize("target", NAMES)
def test_mode_can_be_chosen_on_every_target(mode: str, target: str, places: Places) -> None:
    values = resolve(target, (), [f"CONTROL_CMD_OUTPUT_{mode}=y"], places).values()
    modes = ("DDS_ONLY", "CAN_ONLY", "DDS_AND_CAN")
    assert [name for name in modes if values[f"CONTROL_CMD_OUTPUT_{name}"]] == [mode]
    assert values["CONTROL_CMD_DDS_OUTPUT"] is (mode != "CAN_ONLY")
    assert values["CONTROL_CMD_CAN_OUTPUT"] is values["CAN"] is (mode != "DDS_ONLY")


def test_later_source_wins_and_is_told(places: Places) -> None:
    prj = places.config / "prj_actuation.conf"
    prj.write_text("CONFIG_LOG_LEVEL=0\nCONFIG_LOG_THROTTLE_RATE=4\n")
    board = places.config / "boards" / "posix_actuation.conf"
    board.write_text("# comment\n\nCONFIG_LOG_LEVEL=1\n")
    own = write(places, "own.conf", "CONFIG_LOG_LEVEL=2", "CONFIG_LOG_THROTTLE_RATE=4")
    found = resolve("posix", [own], ["LOG_LEVEL=0"], places)
    assert setting(found, "LOG_LEVEL") == (0, "-D LOG_LEVEL=0")
    assert setting(found, "LOG_THROTTLE_RATE") == (4, "own.conf:2")
    assert found.notes == (
        "config/boards/posix_actuation.conf:3: CONFIG_LOG_LEVEL=1 replaces CONFIG_LOG_LEVEL=0 of "
        "config/prj_actuation.conf:1",
        "own.conf:1: CONFIG_LOG_LEVEL=2 replaces CONFIG_LOG_LEVEL=1 of "
        "config/boards/posix_actuation.conf:3",
        "-D LOG_LEVEL=0: CONFIG_LOG_LEVEL=0 replaces CONFIG_LOG_LEVEL=2 of own.conf:1",
    )


def test_line_replaced_in_the_same_file_is_told(places: Places) -> None:
    own = write(places, "own.conf", "CONFIG_ENABLE_SNTP=y", "# CONFIG_ENABLE_SNTP is not set")
    found = resolve("posix", [own], (), places)
    assert setting(found, "ENABLE_SNTP") == (False, "own.conf:2")
    assert found.notes == (
        "own.conf:2: CONFIG_ENABLE_SNTP=n replaces CONFIG_ENABLE_SNTP=y of own.conf:1",
    )


def test_other_member_of_a_choice_replaces_the_first(places: Places) -> None:
    found = resolve("freertos_posix", (), ["CONFIG_CONTROL_CMD_OUTPUT_CAN_ONLY=y"], places)
    origin = "-D CONFIG_CONTROL_CMD_OUTPUT_CAN_ONLY=y"
    assert setting(found, "CONTROL_CMD_OUTPUT_CAN_ONLY") == (True, origin)
    assert setting(found, "CONTROL_CMD_OUTPUT_DDS_AND_CAN") == (False, origin)
    (note,) = found.notes
    assert note.endswith(
        "replaces CONFIG_CONTROL_CMD_OUTPUT_DDS_AND_CAN=y of "
        "config/boards/freertos_posix_actuation.conf:4"
    )


def test_what_a_later_source_turns_off_is_told_not_refused(places: Places) -> None:
    found = resolve("freertos_posix", (), ["CONTROL_CMD_OUTPUT_DDS_ONLY=y"], places)
    assert found.values()["CAN_DEVICE"] == ""
    assert found.notes[1] == (
        "config/boards/freertos_posix_actuation.conf:5: without effect: "
        'CONFIG_CAN_DEVICE="mock": this needs CAN, which does not hold'
    )


def test_what_a_later_source_makes_possible_is_taken(places: Places) -> None:
    first = write(places, "first.conf", 'CONFIG_SNTP_SERVER="time.example.org"')
    second = write(places, "second.conf", "CONFIG_ENABLE_SNTP=y")
    assert resolve("posix", [first, second], (), places).notes == ()


def test_revision_of_a_board_comes_after_the_board(places: Places) -> None:
    boards = places.config / "boards"
    (boards / "s32z270dc2_rtu0_r52@D_actuation.conf").write_text('CONFIG_CAN_DEVICE="mock"\n')
    found = resolve("s32z270dc2_rtu0_r52@D", places=places)
    origin = "config/boards/s32z270dc2_rtu0_r52@D_actuation.conf:1"
    assert setting(found, "CAN_DEVICE") == ("mock", origin)


FIRMWARE = """
CPP STD_CPP17 REQUIRES_FULL_LIBCPP GLIBCXX_LIBCPP NEWLIB_LIBC POSIX_API PTHREAD_IPC POSIX_THREADS
MAX_PTHREAD_COUNT DYNAMIC_THREAD EVENTFD MAIN_STACK_SIZE HEAP_MEM_POOL_SIZE ISR_STACK_SIZE FPU SMP
MP_MAX_NUM_CPUS TIMEOUT_64BIT SYS_CLOCK_TICKS_PER_SEC NETWORKING NET_IPV4 NET_IPV6 NET_UDP NET_TCP
NET_SOCKETS NET_DHCPV4 NET_IF_MAX_IPV4_COUNT NET_PKT_RX_COUNT NET_BUF_TX_COUNT NET_RX_STACK_SIZE
NET_MGMT_EVENT_STACK_SIZE NET_L2_ETHERNET NET_STATISTICS NET_SHELL DNS_RESOLVER SNTP SHELL LOG
LOG_MODE_MINIMAL PRINTK CONSOLE UART_CONSOLE SERIAL ASSERT DEBUG THREAD_NAME INIT_STACKS MDIO
MDIO_INIT_PRIORITY PHY_INIT_PRIORITY ETH_INIT_PRIORITY CHECK_INIT_PRIORITIES TEST_RANDOM_GENERATOR
ETH_NXP_S32_RX_THREAD_STACK_SIZE ENTROPY_GENERATOR MBEDTLS CAN_LOOPBACK ZVFS_OPEN_MAX
"""


def test_zephyrs_own_symbols_are_one_note(places: Places) -> None:
    lines = [f"CONFIG_{name}=y" for name in FIRMWARE.split()]
    own = write(places, "prj.conf", "CONFIG_LOG_LEVEL=2", *lines, "# CONFIG_NET_TCP is not set")
    found = resolve("posix", [own], (), places)
    assert setting(found, "LOG_LEVEL") == (2, "prj.conf:1")
    count = len(lines)
    assert found.notes == (
        f"prj.conf: {count} symbols are Zephyr's own, without effect: CONFIG_CPP,"
        f" CONFIG_STD_CPP17, CONFIG_REQUIRES_FULL_LIBCPP and {count - 3} more",
    )


def test_a_mistake_beside_zephyrs_symbols_is_still_one(places: Places) -> None:
    own = write(places, "prj.conf", "CONFIG_CPP=y", "CONFIG_THREAD_STACK_SIZ=65536")
    (told,) = mistakes(places, own)
    assert told.startswith("prj.conf:2: unknown symbol CONFIG_THREAD_STACK_SIZ; did you mean")


def test_zephyrs_symbols_are_not_what_a_user_types(places: Places) -> None:
    (told,) = mistakes(places, overrides=("POSIX_API=y",))
    assert "unknown symbol CONFIG_POSIX_API" in told


@pytest.mark.parametrize("bom", [b"", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("end", [b"", b"\n", b"\r\n", b"   \r\n"])
def test_a_file_of_any_editor_is_read(places: Places, bom: bytes, end: bytes) -> None:
    own = write(places, "own.conf")
    own.write_bytes(bom + b"CONFIG_LOG_LEVEL=2" + end)
    assert setting(resolve("posix", [own], (), places), "LOG_LEVEL") == (2, "own.conf:1")


@pytest.mark.parametrize("row", TARGETS, ids=lambda row: row.name)
def test_result_is_that_of_kconfiglib_alone(row: Target, places: Places) -> None:
    """The same files, loaded one after the other as Zephyr's script does."""
    own = write(places, "own.conf", "CONFIG_ENABLE_SNTP=y", 'CONFIG_NET_IFACE1_ADDR="10.0.0.2"')
    zephyr = kconfiglib.Kconfig(str(places.kconfig), warn_to_stderr=False)
    for path in (*places.fragments_of(row), own):
        zephyr.load_config(str(path), replace=False)
    found = resolve(row.name, [own], (), places)
    expected = {item.name: item.config_string.strip() for item in zephyr.unique_defined_syms}
    assert {item.symbol: item.line for item in found.settings} == expected
    reread = kconfiglib.Kconfig(str(places.kconfig), warn_to_stderr=False)
    dotconfig = write(places, "dotconfig", found.dotconfig().rstrip())
    reread.load_config(str(dotconfig))
    assert not reread.warnings
    assert {s.name: s.config_string.strip() for s in reread.unique_defined_syms} == expected


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("CONFIG_LOGLEVEL=2", "unknown symbol CONFIG_LOGLEVEL; did you mean 'CONFIG_LOG_LEVEL'?"),
        ("CONFIG_NOSUCH=y", "unknown symbol CONFIG_NOSUCH; see 'island config show'"),
        (
            "CONFIG_NET_IFACE1_ADR=2",
            "unknown symbol CONFIG_NET_IFACE1_ADR; did you mean 'CONFIG_NET_",
        ),
        ("CONFIG_LOG_LEVL=2", "unknown symbol CONFIG_LOG_LEVL; did you mean 'CONFIG_LOG_LEVEL'?"),
        ("CONFIG_CONTROL_CMD_OUTPUT_MODE=y", "CONFIG_CONTROL_CMD_OUTPUT_MODE is a choice: set one"),
        ("CONFIG_CAN=y", "CONFIG_CAN cannot be set: it follows from CONFIG_CONTROL_CMD_OUTPUT_CAN"),
        ("CONFIG_CONTROL_CMD_DDS_OUTPUT=n", "CONFIG_CONTROL_CMD_DDS_OUTPUT cannot be set"),
        ("CONFIG_ENABLE_SNTP=yes", "CONFIG_ENABLE_SNTP=yes: expected y or n"),
        ("CONFIG_ENABLE_SNTP=m", "CONFIG_ENABLE_SNTP=m: expected y or n"),
        ("CONFIG_LOG_LEVEL=two", "CONFIG_LOG_LEVEL=two: expected a whole number"),
        ("CONFIG_LOG_LEVEL=", "CONFIG_LOG_LEVEL=: expected a whole number"),
        ("CONFIG_LOG_LEVEL=3", "CONFIG_LOG_LEVEL=3: expected a whole number from 0 to 2"),
        ("CONFIG_LOG_LEVEL=-1", "CONFIG_LOG_LEVEL=-1: expected a whole number from 0 to 2"),
        ("CONFIG_DDS_DOMAIN_ID=233", "CONFIG_DDS_DOMAIN_ID=233: expected a whole number from 0"),
        ("CONFIG_THREAD_STACK_SIZE=1", "expected a whole number from 65536 to 67108864"),
        ("CONFIG_DDS_NETWORK_INTERFACE=eth0", "expected a text in quotes"),
        ('CONFIG_DDS_NETWORK_INTERFACE="eth0', "expected a text in quotes"),
        ('CONFIG_SNTP_SERVER="a"', "this needs ENABLE_SNTP, which does not hold"),
        ('CONFIG_CAN_DEVICE="mock"', "this needs CAN, which does not hold"),
        ('CONFIG_NET_IFACE1_GW="10.0.0.1"', 'this needs NET_IFACE1_ADDR != "", which does not'),
        ("CONFIG_NET_IFACE2_VLAN=5", 'this needs NET_IFACE2_NAME != "", which does not hold'),
        ("# CONFIG_CONTROL_CMD_OUTPUT_DDS_ONLY is not set", "exactly one of CONFIG_CONTROL_CMD"),
        (" CONFIG_LOG_LEVEL=2", "cannot read 'CONFIG_LOG_LEVEL=2', expected CONFIG_NAME=value"),
        ("LOG_LEVEL=2", "cannot read 'LOG_LEVEL=2', expected CONFIG_NAME=value"),
        ("CONFIG_LOG_LEVEL 2", "cannot read 'CONFIG_LOG_LEVEL 2', expected CONFIG_NAME=value"),
    ],
)
def test_refused_line_is_told_with_file_and_line(line: str, told: str, places: Places) -> None:
    own = write(places, "own.conf", "", "# comment", line)
    (mistake,) = mistakes(places, own)
    assert mistake.startswith("own.conf:3: ")
    assert told in mistake


def test_every_mistake_of_one_kind_is_told_at_once(places: Places) -> None:
    one = write(places, "one.conf", "CONFIG_A=1", "CONFIG_LOG_LEVEL=x")
    two = write(places, "two.conf", "CONFIG_B=1")
    told = mistakes(places, one, two, overrides=("C=1",))
    places_told = [text.partition(": ")[0] for text in told]
    assert places_told == ["one.conf:1", "one.conf:2", "two.conf:1", "-D C=1"]
    told = mistakes(places, places.config / "none.conf", overrides=("LOG_LEVEL",))
    assert told == [
        "config/none.conf: cannot read this configuration: No such file or directory",
        "-D LOG_LEVEL: expected NAME=value, for example LOG_LEVEL=2",
    ]


def test_file_that_is_not_text_is_refused(places: Places) -> None:
    path = places.config.parent / "bad.conf"
    path.write_bytes(b"CONFIG_LOG_LEVEL=\xff\n")
    assert mistakes(places, path) == [
        "bad.conf: cannot read this configuration: it is not UTF-8 text (at byte 17)"
    ]
    (told,) = mistakes(places, places.config)
    assert told == "config: cannot read this configuration: Is a directory"


def test_line_ends_of_other_systems_are_read(places: Places) -> None:
    path = places.config.parent / "dos.conf"
    path.write_bytes(b'CONFIG_LOG_LEVEL=2\r\nCONFIG_DDS_NETWORK_INTERFACE="eth0"\r\n')
    values = resolve("posix", [path], (), places).values()
    assert (values["LOG_LEVEL"], values["DDS_NETWORK_INTERFACE"]) == (2, "eth0")


@pytest.mark.parametrize("value", ["eth0", '"eth0"'])
def test_override_takes_a_text_with_and_without_quotes(value: str, places: Places) -> None:
    found = resolve("posix", (), [f"DDS_NETWORK_INTERFACE={value}"], places)
    assert found.values()["DDS_NETWORK_INTERFACE"] == "eth0"


def test_text_keeps_its_quotes_and_backslashes(places: Places) -> None:
    own = write(places, "own.conf", r'CONFIG_DDS_NETWORK_INTERFACE="a\"b\\c"')
    found = resolve("posix", [own], (), places)
    assert found.values()["DDS_NETWORK_INTERFACE"] == r"a\"b\c".replace(r"\"", '"')
    assert own.read_text().strip() in found.dotconfig().splitlines()


def test_mistake_in_kconfig_itself_is_one_line(places: Places) -> None:
    places.kconfig.write_text("config A\n\tbool\n\tdefault maybe maybe\n")
    (told,) = mistakes(places)
    assert told.startswith("config/Kconfig: cannot be read as Kconfig: ")
    places.kconfig.unlink()
    (told,) = mistakes(places)
    assert told.startswith("config/Kconfig: cannot be read as Kconfig: ")


def test_same_configuration_gives_the_same_bytes(places: Places) -> None:
    texts = {resolve("freertos_posix", places=places).dotconfig() for _ in range(3)}
    assert len(texts) == 1
