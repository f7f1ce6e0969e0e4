# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Write events into a node's log."""

from bearing_sim.events import Event, Level


def log_event(logger, event: Event, name: str = "") -> None:
    """Log an event at its level, after the name of the bearing where it has one."""
    line = f"{name}: {event.code}: {event.text}" if name else f"{event.code}: {event.text}"
    # rclpy refuses a line of code that logs at more than one severity.
    if event.level == Level.ERROR:
        logger.error(line)
    elif event.level == Level.WARN:
        logger.warning(line)
    else:
        logger.info(line)
