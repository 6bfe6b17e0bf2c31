# SPDX-License-Identifier: Apache-2.0
"""libddsc, the C library of CycloneDDS: found, loaded, and called through its public functions.

Releases 0.10 (Debian, Ubuntu, ROS 2 Humble to Jazzy) and 11 (the wheel on PyPI) serve. Nothing of
the Python package ``cyclonedds`` is imported: where it is installed its library is used.
"""
