# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""By which methods each level can be integrated; the names that a scene may give.

Names only, so that a scene can be read without the models; `bearing_sim.levels.level` binds them.
"""

# The first of a level is its own, taken where the scene names none.
METHODS = {
    "steady": ("lag",),
    "slip": ("rosenbrock2", "bdf", "rk45"),
    "planar": ("sdirk2", "bdf", "rk45"),
    "spatial": ("sdirk2", "bdf", "rk45"),
}
# Methods that can keep to one step; the others live by their error estimates.
FIXED_STEP = ("rosenbrock2", "sdirk2")
