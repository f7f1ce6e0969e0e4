# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``python -m bearing_sim.cli``: the same as ``bearing-sim``."""

from bearing_sim.cli.main import main

if __name__ == "__main__":
    main(prog_name="bearing-sim")
