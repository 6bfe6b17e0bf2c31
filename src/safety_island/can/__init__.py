# SPDX-License-Identifier: Apache-2.0
"""CAN output: three classic frames for each command, the backends, the monitor, the DBC.

The one table of frames and signals stands in ``command.frames``, beside the kernel that encodes
them; the decoder, the DBC file (``dbc``) and the tables of ``docs/can.md`` (``tables``) derive from
it.
"""
