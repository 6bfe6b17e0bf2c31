# SPDX-License-Identifier: Apache-2.0
"""Symbols of Zephyr itself, as the firmware's ``prj.conf`` has them beside the island's.

Zephyr has some twenty thousand symbols. Their first words are few; a symbol that is one letter or
two from one of the island's is a mistake, whatever it begins with.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from safety_island.targets.kconfig.fragment import PREFIX, Assignment
from safety_island.words import nearest

NAMED = 3
"""Symbols that a note names; the others are counted."""
_TYPING_ERROR = 0.87
"""Likeness to a symbol of the island from which on it is meant."""

_FIRST_WORDS = """
ADC ARCH ARM ARM64 ARMV8 ASAN ASSERT ATOMIC AUDIO BASE64 BOARD BOOT BOOTLOADER BT BUILD CACHE
CAN CBPRINTF CHECK CLOCK CMSIS CODE COMMON COMPILER CONSOLE COREDUMP COUNTER COVERAGE CPP CPU
CRC CRYPTO DAC DEBUG DEPRECATION DEVICE DISK DISPLAY DMA DNS DSP DYNAMIC EARLY ENTROPY ERRNO
ETH ETHERNET EVENTFD EVENTS EXCEPTION EXTERNAL EXTRA FAT FATAL FAULT FILE FLASH FLOAT FP FPU FS
GCC GEN GIC GLIBCXX GPIO HAS HEAP HTTP HW HWINFO I2C I2S IDLE INCLUDE INIT INPUT INTERRUPT IPC
IPM IRQ ISOTP ISR JSON KERNEL KOBJECT LIB LIBCPP LIBCXX LIBLTO LINKER LITTLEFS LLEXT LLVM LOG
LTO MAIN MAX MBEDTLS MBOX MCUBOOT MCUX MDIO MEM MEMORY MINIMAL MM MMU MODULES MP MPU MQTT MULTI
MULTITHREADING NANO NATIVE NET NETWORKING NEWLIB NO NOCACHE NUM NVMEM NVS NXP OBJ OPENAMP
OUTPUT PARTITION PHY PICOLIBC PIN PINCTRL PIPES PM POLL POSIX POWER PRINTK PRIORITY PRIVILEGED
PROFILING PTHREAD PTP PWM QEMU RAM RANDOM REBOOT REQUIRES RESET RETAINED RING ROM RTIO RTT RUST
SCHED SCHEDULER SECOND SECURE SEGGER SEM SENSOR SERIAL SETTINGS SHELL SIMULATOR SIZE SMBUS SMP
SNTP SOC SPEED SPI SPIN SRAM STACK STATIC STATISTICS STATS STD STDIN STDOUT STREAM SYMTAB SYS
SYSTEM TASK TEST TFM THREAD TICKLESS TIMEOUT TIMER TIMESLICE TIMESLICING TIMING TINYCRYPT TLS
TOOLCHAIN TRACING TRUSTED UART UBSAN UNITY UPDATEABLE USB USE USERSPACE VIRTIO WARN WATCHDOG
WDT WEBSOCKET WIFI XIP ZBUS ZEPHYR ZTEST ZVFS
"""
_WORDS = frozenset(_FIRST_WORDS.split())


def is_zephyrs(name: str, ours: Sequence[str]) -> bool:
    """Whether a symbol that is not ``ours`` belongs to Zephyr."""
    begins_so = name.partition("_")[0] in _WORDS
    return begins_so and nearest(name, ours, _TYPING_ERROR) is None


def notes(assignments: Iterable[Assignment]) -> list[str]:
    """Say in one line for each file which symbols in it mean nothing here."""
    by_file: dict[str, list[str]] = {}
    for item in assignments:
        file = item.place.rpartition(":")[0]
        by_file.setdefault(file, []).append(PREFIX + item.symbol)
    return [f"{file}: {_sentence(list(dict.fromkeys(found)))}" for file, found in by_file.items()]


def _sentence(names: list[str]) -> str:
    verb = "symbol is" if len(names) == 1 else "symbols are"
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return f"{len(names)} {verb} Zephyr's own, without effect: {', '.join(names[:NAMED])}{more}"
