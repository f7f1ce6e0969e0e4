# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Settings for estimating the cage speed from vibration in a live run.

Without them a run does not listen to the vibration.
"""

from typing import Annotated

from bearing_sim.scene.quantity import Quantity, record


@record
class VibrationInput:
    """Blocks of samples of an accelerometer, from which the cage speed is found window by window."""

    window: Annotated[
        float, Quantity("s", "length of the windows; 0: the topic vibration is not listened to; some hundred turns of the shaft are good", 0.0, 600.0)
    ] = 0.0
    rate: Annotated[float, Quantity("Hz", "sampling rate of blocks that do not say theirs; 0: they must", 0.0, 1e7)] = 0.0
    tolerance: Annotated[
        float, Quantity("", "within which the measured shaft speed is right: the shaft's own lines are searched there", 1e-4, 0.2, "%")
    ] = 0.01

    largest_slip: Annotated[
        float,
        Quantity(
            "", "of the cage that is possible at the loads of the run, beside the band of the model: no other lines are looked for", 0.0, 0.95, "%"
        ),
    ] = 0.1

    @property
    def is_asked(self) -> bool:
        """Whether the scene asks for the cage speed out of vibration."""
        return self.window > 0.0
