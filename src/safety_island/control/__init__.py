"""The trajectory follower: array mathematics only, no clock, no I/O, no allocation in a tick."""
