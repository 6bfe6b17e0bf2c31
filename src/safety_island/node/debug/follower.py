# SPDX-License-Identifier: Apache-2.0
"""A trajectory follower whose memory may be read between two ticks."""

from __future__ import annotations

from typing import Any

import numpy as np

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.params import Parameters
from safety_island.control.qp_alone import condense_problem
from safety_island.control.qp_records import QP
from safety_island.kernel.records import Records


class ObservedFollower(TrajectoryFollower):
    """The same controllers; an observer reads their records and writes none."""

    def __init__(self, parameters: Parameters) -> None:
        super().__init__(parameters)
        condense_problem.prepare()
        self._whole: Records = np.zeros(1, QP)

    @property
    def params(self) -> Any:
        """PARAMS: parameters and rules."""
        return self._params[0]

    @property
    def lateral(self) -> Any:
        """LATERAL_STATE."""
        return self._lateral[0]

    @property
    def longitudinal(self) -> Any:
        """LONGITUDINAL_STATE."""
        return self._longitudinal[0]

    @property
    def path(self) -> Records:
        """The list that the last longitudinal tick worked on; its length is ``longitudinal.n``."""
        return self._work

    @property
    def problem(self) -> Any:
        """QP: the last quadratic programme, whole, though the solver may have needed no matrix."""
        condense_problem.call(self._params, self._lateral.copy(), self._whole)
        return self._whole[0]
