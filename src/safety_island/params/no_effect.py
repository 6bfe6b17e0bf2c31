# SPDX-License-Identifier: Apache-2.0
"""Keys of Autoware's real files that have no effect here, each with the reason.

They are accepted, so that those files load unchanged, and reported (``Loaded.ignored``). A key that
would have an effect in a release of Autoware and not here is not among them.
"""

from __future__ import annotations

from dataclasses import dataclass

_PREDICTED = "'island run --debug-topics' publishes the predicted trajectory"
_OTHERS = "this topic is not published; others are, by 'island run --debug-topics'"
_UNREAD = "no release of Autoware reads it either"
_LOADS = "follows from the loads of the wheels and the wheelbase"
_NESTED = "Autoware does not read it here either, only below 'vehicle:'"


@dataclass(frozen=True)
class NoEffect:
    """Why a key has no effect; ``only`` is the one value that it may have, None when any."""

    reason: str
    only: object = None


NO_EFFECT: dict[str, NoEffect] = {
    # lateral/mpc.param.yaml
    "acceleration_limit": NoEffect(f"{_UNREAD}; mpc_acceleration_limit acts"),
    "velocity_time_constant": NoEffect(f"{_UNREAD}; mpc_velocity_time_constant acts"),
    "use_delayed_initial_state": NoEffect(
        "the predicted trajectory of '--debug-topics' begins after the delay"
    ),
    "publish_debug_trajectories": NoEffect(_OTHERS),
    "debug_publish_predicted_trajectory": NoEffect(_PREDICTED),
    "debug_publish_resampled_reference_trajectory": NoEffect(_OTHERS),
    "mass_kg": NoEffect(_NESTED),
    "mass_fl": NoEffect(_NESTED),
    "mass_fr": NoEffect(_NESTED),
    "mass_rl": NoEffect(_NESTED),
    "mass_rr": NoEffect(_NESTED),
    "cf": NoEffect(_NESTED),
    "cr": NoEffect(_NESTED),
    "vehicle.mass_kg": NoEffect(_LOADS),
    "vehicle.cg_to_front_m": NoEffect(_LOADS),
    "vehicle.cg_to_rear_m": NoEffect(_LOADS),
    # longitudinal/pid.param.yaml
    "stopped_jerk": NoEffect(_UNREAD),
    # trajectory_follower_node.param.yaml
    "enable_control_cmd_horizon_pub": NoEffect("'island run --debug-topics' publishes the horizon"),
    "use_trajectory_steering_for_feedforward": NoEffect(
        "an open proposal, in no release", only=False
    ),
    # what ros2 param dump adds
    "use_sim_time": NoEffect("time is the machine's own", only=False),
    "start_type_description_service": NoEffect("this node has no services"),
}

PREFIXES: dict[str, NoEffect] = {
    "qos_overrides.": NoEffect("the QoS of each topic is fixed by its contract"),
}
"""The same for all keys that begin so."""


def no_effect(key: str) -> NoEffect | None:
    """Return why a key has no effect, None when it is not a key of this kind."""
    for prefix, reason in PREFIXES.items():
        if key.startswith(prefix):
            return reason
    return NO_EFFECT.get(key)
