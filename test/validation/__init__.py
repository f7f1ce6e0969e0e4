# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the model has been compared with: each comparison is a check that computes its figure and holds it to its tolerance."""
