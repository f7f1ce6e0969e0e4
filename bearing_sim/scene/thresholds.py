# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The thresholds of a scene: when the condition of a bearing is a warning or an error, and how changes are detected in noise."""

from dataclasses import field

from bearing_sim.scene.quantity import check, quantity, record


@record
class Hold:
    """Hysteresis and delays of an alarm (see `bearing_sim.monitoring.monitor.Alarm`)."""

    hysteresis: quantity("", "fraction of the limit by which a value must return before the alarm clears", 0.0, 0.9, "%") = 0.1
    raise_after: quantity("s", "time beyond the limit before the alarm is raised", 0.0, 86400.0) = 0.5
    clear_after: quantity("s", "time back within the limit before the alarm clears", 0.0, 86400.0) = 2.0


@record
class ResidualDetection:
    """How measured slip is compared with predicted slip (see `bearing_sim.monitoring.residual`)."""

    false_alarm_time: quantity("s", "mean time between false alarms", 60.0, 1e10, "h") = 3.6e6
    tolerance: quantity("", "lasting change of the residual that is not a fault: the error of the model between conditions", 1e-6, 1.0, "%") = 0.002
    batch: quantity("s", "time over which residuals are averaged before the test", 0.01, 3600.0) = 1.0
    learning: quantity("s", "measured time from which the reference mean and scatter of the residual are learned", 1.0, 1e6) = 120.0
    settling: quantity("s", "time after rest or a change of speed that is ignored", 0.0, 3600.0) = 5.0
    memory: quantity("s", "time constant of the displayed exponential mean and standard deviation", 0.1, 1e6) = 60.0

    @check
    def _times_fit_together(self) -> list[str]:
        errors = []
        if self.learning < 30 * self.batch:
            errors.append(f"learning: {self.learning:g} s are {self.learning / self.batch:.3g} batches of {self.batch:g} s; expected 30 or more")
        if self.false_alarm_time < 20 * self.batch:
            errors.append(f"false_alarm_time: {self.false_alarm_time:g} s is less than 20 batches of {self.batch:g} s")
        return errors


@record
class Thresholds:
    """When the condition is a warning or an error."""

    slip_warning: quantity("", "cage slip that is a warning", 0.0, 1.0, "%") = 0.05
    slip_error: quantity("", "cage slip that is an error (Deng 2017: 10 %)", 0.0, 1.0, "%") = 0.10
    # Just above rest the slip may be large, but it does no harm.
    slip_from_speed: quantity("rad/s", "shaft speed above which slip and film are monitored", 0.0, 12000.0, "rpm") = 20.0
    slip_hold: Hold = field(default_factory=Hold)
    life_warning: quantity("h", "rating life below which there is a warning (Deng 2017: 300 h)", 0.0, 1e9) = 300.0
    life_error: quantity("h", "rating life below which there is an error; 0: never", 0.0, 1e9) = 0.0
    life_hold: Hold = field(default_factory=Hold)
    remaining_life_warning: quantity("h", "remaining life below which there is a warning (Deng 2017: 300 h)", 0.0, 1e9) = 300.0
    remaining_life_error: quantity("h", "remaining life below which there is an error; 0: never", 0.0, 1e9) = 0.0
    remaining_life_memory: quantity("s", "time constant of the mean damage rate from which remaining life is computed", 1e-3, 1e9) = 60.0
    remaining_life_hold: Hold = field(default_factory=Hold)
    lambda_warning: quantity("", "film thickness over roughness below which there is a warning", 0.0, 100.0) = 1.0
    lambda_error: quantity("", "film thickness over roughness below which there is an error; 0: never", 0.0, 100.0) = 0.0
    lambda_hold: Hold = field(default_factory=Hold)
    pocket_force_warning: quantity("N", "pocket force that is a warning; None: none is", 0.0, 1e6) | None = None
    pocket_force_error: quantity("N", "pocket force that is an error; None: none is", 0.0, 1e6) | None = None
    pocket_force_hold: Hold = field(default_factory=Hold)
    residual: ResidualDetection = field(default_factory=ResidualDetection)
