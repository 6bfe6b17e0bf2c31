# SPDX-License-Identifier: Apache-2.0
"""The status as Python values; units and meanings stand in ``msg/safety_island_msgs``."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.messages.wire import Time


class InputStatus(NamedTuple):
    """What became of the samples of one input."""

    refused: tuple[int, ...]
    writer_guid: bytes
    sample_stamp: int
    source_time: int
    accepted: int
    received: int
    superseded: int
    refused_in_a_row: int
    age: float
    age_limit: float
    transport_delay: float
    warnings: int
    last_refusal: int
    other_writers: int


class Status(NamedTuple):
    """What the island did in one tick, and why; enumerations are numbers."""

    stamp: Time
    now: int
    arm_nonce: int
    tick: int
    commands: int
    memory: int
    foreign_can_frames: int
    parameters_hash: int
    snapshot_layout: int
    lateral_error: float
    yaw_error: float
    residual: float
    stop_dist: float
    target_vel: float
    command_angle: float
    command_rate: float
    command_velocity: float
    command_acceleration: float
    tick_time: float
    lateral_time: float
    longitudinal_time: float
    lateness: float
    missed_periods: int
    missed_periods_total: int
    overruns: int
    controller_limits: int
    guard_limits: int
    guard_clamped: int
    guard_refused: int
    sequence: int
    output_failures: int
    solver_status: int
    solver_iterations: int
    active_constraints: int
    state: int
    reason: int
    subject: int
    latched_cause: int
    operation_mode: int
    longitudinal_state: int
    mpc_status: int
    guard_verdict: int
    output_mode: int
    arm_result: int
    other_control_writers: int
    degraded: bool
    armed: bool
    engaged: bool
    control_enabled: bool
    published: bool
    inputs: tuple[InputStatus, ...]
