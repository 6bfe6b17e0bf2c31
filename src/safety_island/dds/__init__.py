# SPDX-License-Identifier: Apache-2.0
"""DDS for the safety island: participant, publisher, subscription, QoS, configuration, topics."""
