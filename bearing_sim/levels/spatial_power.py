"""Power by cause at level ``spatial``."""

from bearing_sim.kernels.compilation import kernel
from bearing_sim.levels.power import Powers


@kernel
def spatial_powers(y, shaft_speed, model, work):
    """To come."""
    return Powers(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
