# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How sure a prediction is: bands by a scene's uncertain fields, live."""
