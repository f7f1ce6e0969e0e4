# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What watches a run: its limits, bands and calibration, the vibration beside it, and the stored state of its bearing."""
