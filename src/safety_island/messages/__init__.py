# SPDX-License-Identifier: Apache-2.0
"""Messages of the safety island: IDL files, type registry, and the codecs from bytes and back."""
