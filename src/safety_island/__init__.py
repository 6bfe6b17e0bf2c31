"""Autoware's trajectory follower on a safety island: MPC and PID over DDS and CAN."""

__version__ = "0.2.0"
