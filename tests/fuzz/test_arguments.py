# SPDX-License-Identifier: Apache-2.0
"""Words on the command line that no program expects: one line, and never a fault of the island."""

from __future__ import annotations

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from safety_island.cli.main import main
from tests.fuzz.limits import limited

COMMANDS = (
    ("can", "send", "--print", "--stamp"),
    ("can", "send", "--print", "--sequence"),
    ("can", "send", "--print", "--angle"),
    ("can", "send", "--can"),
    ("can", "monitor", "--period"),
    ("config", "show", "-t", "posix", "-D"),
    ("config", "show", "-t"),
    ("params", "check"),
    ("run", "--platform", "sim", "--duration", "0.01", "--params"),
    ("run", "--domain"),
    ("run", "--duration", "0.01", "-D", "NET_DHCPV4_INITIAL_DELAY_MAX=0", "--interface"),
    ("bridge", "--duration", "0.1"),
    ("replay",),
)

WORDS = st.one_of(
    st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=20),
    st.from_regex(r"[-+]?[0-9]{0,30}(\.[0-9]{0,5})?([eE][-+]?[0-9]{0,12})?", fullmatch=True),
    st.sampled_from(["nan", "inf", "-inf", "9" * 5000, "1e999999999", "٣", "²", "LOG_LEVEL="]),
    st.builds("LOG_LEVEL={}".format, st.sampled_from(["9" * 5000, "-0", "0x1", "y", '"', "²"])),
    st.builds("mock:,{}={}".format, st.sampled_from("ab"), st.sampled_from(["1e999", "_", "nan"])),
)


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
@example(word="1e999999999")
@example(word="9" * 5000)
@example(word="LOG_LEVEL=" + "9" * 5000)
@example(word="\x1b[2J")
@example(word="a\u2028b")
@settings(max_examples=25)
@given(word=WORDS)
def test_a_word_is_taken_or_refused_in_lines(command: tuple[str, ...], word: str) -> None:
    with pytest.MonkeyPatch.context() as patch:
        told: list[str] = []
        patch.setattr("sys.stderr.write", told.append)
        with limited():
            try:
                code = main([*command, word])
            except SystemExit as end:  # argparse: --help
                code = int(end.code or 0)
    lines = "".join(told).splitlines()
    assert code in (0, 1, 2), lines
    assert (code == 0) or any(line.startswith("island: error: ") for line in lines), lines
    assert all(line.isprintable() for line in lines), lines
