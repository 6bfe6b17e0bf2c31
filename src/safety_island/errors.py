# SPDX-License-Identifier: Apache-2.0
"""Errors that a user can mend; the command line prints them as one line and exits non-zero."""


class IslandError(Exception):
    """What was found, what was expected, where, and what to do, in one line."""

    exit_code = 1


class ConfigurationError(IslandError):
    """A configuration file, option or environment variable that cannot be used."""

    exit_code = 2
