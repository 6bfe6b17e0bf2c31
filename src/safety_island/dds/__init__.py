"""DDS for the safety island: participant, publisher, subscription, QoS, configuration, topics."""
