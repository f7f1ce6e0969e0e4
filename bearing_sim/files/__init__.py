# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Files of users: how outputs are written so that nothing is lost, and within which limits inputs are read."""
