# SPDX-License-Identifier: Apache-2.0
"""PID of the speed error, and the first-order low pass before it."""

from safety_island.control.geometry import clip
from safety_island.kernel.kernel import kernel


@kernel
def low_pass(memory, gain, value):
    """First-order low pass: ``gain`` is the part of the old value that stays."""
    return gain * memory + (1.0 - gain) * value


@kernel
def pid_reset(memory):
    """Forget the integral and the previous error of a PID_MEMORY record."""
    memory.integral = 0.0
    memory.error_prev = 0.0
    memory.started = False


@kernel
def pid_step(p, memory, error, dt, integrate):
    """Return (sum, P, I, D) [m/s^2] for a speed error [m/s]; each term and the sum are limited.

    The integral itself is held in the range that its term may use; it rests while ``integrate`` is
    false. D is 0 on the first call after a reset.
    """
    p_term = clip(p.kp * error, p.min_p_effort, p.max_p_effort)
    if integrate and p.ki > 0.0:
        grown = memory.integral + error * dt
        memory.integral = clip(grown, p.min_i_effort / p.ki, p.max_i_effort / p.ki)
    i_term = p.ki * memory.integral
    d_term = 0.0
    if memory.started:
        d_term = clip(p.kd * (error - memory.error_prev) / dt, p.min_d_effort, p.max_d_effort)
    memory.error_prev = error
    memory.started = True
    return clip(p_term + i_term + d_term, p.min_out, p.max_out), p_term, i_term, d_term
