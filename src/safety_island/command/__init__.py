# SPDX-License-Identifier: Apache-2.0
"""What leaves the island, as kernels: the bytes of ``Control``, the three CAN frames, the status.

``frames`` holds the one table of CAN frames and signals: the encoder here, and in ``can`` the
decoder, the DBC file and the tables of ``docs/can.md`` derive from it. The layouts of the two
messages derive from their IDL files.
"""
