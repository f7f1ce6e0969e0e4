# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Materials of rings, rollers, cage, shaft and housing; ``catalog/materials`` holds some by name."""

from typing import Annotated

from bearing_sim.scene.quantity import Quantity, record


@record
class Material:
    """Elastic, thermal and strength constants of a solid; the defaults are those of through-hardened bearing steel."""

    name: str = "bearing steel"  # name of the material
    source: str = "handbook values of through-hardened bearing steel"  # where its constants come from
    youngs_modulus: Annotated[float, Quantity("Pa", "Young's modulus, E", 1e8, 1e12, "GPa")] = 2.06e11
    poisson_ratio: Annotated[float, Quantity("", "Poisson's ratio, nu", 0.0, 0.49)] = 0.3
    density: Annotated[float, Quantity("kg/m^3", "density", 500.0, 25e3)] = 7850.0
    expansion: Annotated[float, Quantity("1/K", "linear thermal expansion, alpha", 0.0, 1e-3)] = 1.2e-5
    thermal_conductivity: Annotated[float, Quantity("", "thermal conductivity [W/(m K)]", 0.05, 500.0)] = 46.0
    specific_heat: Annotated[float, Quantity("", "specific heat [J/(kg K)]", 50.0, 5000.0)] = 475.0
    strength: Annotated[float, Quantity("Pa", "tensile strength, at which a ring is taken to burst", 1e6, 5e9, "MPa")] = 1.5e9
