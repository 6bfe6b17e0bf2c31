# SPDX-License-Identifier: Apache-2.0
"""CAN output: three classic frames for each command, the modes, the backends, the DBC.

``frames`` holds the one table of frames and signals; the encoder and decoder (``codec``), the DBC
file (``dbc``) and the tables of ``docs/can.md`` (``tables``) derive from it.
"""
