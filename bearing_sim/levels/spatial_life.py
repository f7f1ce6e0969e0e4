"""Life by slices at level ``spatial``: running means of the slices' loads (ISO/TS 16281, see `bearing_sim.rating_life`)."""

from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.lanes import load, spread, square_root, total
from bearing_sim.levels.spatial_slices import SLICED, slice_force
from bearing_sim.levels.spatial_state import ROLLER


@kernel
def average_slices(share, params, work):
    """Take the slices' loads of this instant, stress risers included, into their running means to the exponents of both rings.

    The means are those of `bearing_sim.rating_life.add_slice_powers`; the first instant starts them.

    Parameters
    ----------
    share : weight of this instant.
    params, work : of the level; the right-hand side has been evaluated into ``work``.
    """
    slices, contacts, means = params.slices, work.contacts, work.slice_means
    number, blocks = slices.places.shape[0], work.rollers.shape[0]
    part, damping = params.raceways.stiffness / number, params.ring.contact_damping
    started = 0.0
    for k in range(number):
        started += means[0, k] + means[1, k]
    weight = share if started > 0.0 else 1.0  # the end slices of a crowned roller may never be loaded
    for k in range(number):
        rotating, stationary = spread(0.0), spread(0.0)
        for block in range(blocks):
            present = load(work.rollers, block, ROLLER.present)
            inner = slices.risers[k] * _slice_load(block, k, contacts, slices, part, damping)
            outer = slices.risers[k] * _slice_load(blocks + block, k, contacts, slices, part, damping)
            rotating += present * (inner * inner) * (inner * inner)
            stationary += present * (outer * outer) * (outer * outer) * square_root(outer)
        count = params.rollers.count
        means[0, k] += weight * (total(rotating) / count - means[0, k])
        means[1, k] += weight * (total(stationary) / count - means[1, k])


@kernel
def _slice_load(block, k, contacts, slices, part, damping):
    """Return the normal force of slice k of a block of contacts [N]."""
    x = slices.places[k]
    depth = load(contacts, block, SLICED.penetration) + load(contacts, block, SLICED.lean) * x - slices.crown[k]
    rate = load(contacts, block, SLICED.rate) + load(contacts, block, SLICED.lean_rate) * x
    return slice_force(depth, rate, part, damping)[0]
