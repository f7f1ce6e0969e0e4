# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The parameters of compiled code: plain numbers in nested named tuples; `pack` makes them from a scene."""

import functools
import math
from typing import NamedTuple

import numpy as np

from bearing_sim.model.oil import oil_at, pressure_index, shear_strength
from bearing_sim.model.running_clearance import mounted, running_play, seat_compliance, uniform
from bearing_sim.physics.contact import ContactDamping, iso_contact_stiffness, line_contact_stiffness
from bearing_sim.physics.drag import LARGEST_FRACTION, Bath, bath_drag, swept_fraction
from bearing_sim.physics.film import RollingResistance, resistance_constants
from bearing_sim.physics.flange import NO_FACE, Flanges, corner_stiffness, flange_face, rim_corner
from bearing_sim.physics.growth import Growth, Mounted, Temperatures, growth_at
from bearing_sim.physics.lamina_life import Laminae, new_laminae
from bearing_sim.physics.mixed import FILM_RATIO, NONE, SKF, MixedFriction, hysteresis_constant, skf_constant
from bearing_sim.physics.outer_ring import RingSection, bed_compliance, bore_compliance, ring_compliance
from bearing_sim.physics.profile import Profile, new_profile
from bearing_sim.physics.raceway import tabulated
from bearing_sim.physics.rating_life import METHODS, cleanliness, reliability_factor, ring_ratings
from bearing_sim.physics.ring_balance import ElasticRing, Seat, new_elastic_ring
from bearing_sim.physics.squeeze_film import SqueezeFilm, new_squeeze_film
from bearing_sim.physics.starvation import MinimumLoad, Starvation, starvation_rate
from bearing_sim.physics.traction import TractionConstants, constant_constants, kragelskii_constants, oil_4109_constants, thermal_eyring_constants
from bearing_sim.scene.axial_load import equivalent_load_law
from bearing_sim.scene.bearing import Roller
from bearing_sim.scene.contour import outer_contour
from bearing_sim.scene.crown import IsoLogCrown, NoCrown, StraightArcCrown, crown_drops, log_scale, slice_middles
from bearing_sim.scene.flanges import flange_geometry
from bearing_sim.scene.lubricant import ConstantTraction, EyringTraction, HydrodynamicRollingResistance, KragelskiiTraction
from bearing_sim.scene.outer_ring import ring_geometry
from bearing_sim.scene.ratings import minimum_load_law, rate
from bearing_sim.scene.scene import Bearing, Lubricant, Scene
from bearing_sim.scene.support import settled_support


class Rollers(NamedTuple):
    """The set of rollers."""

    count: int  # Z
    radius: float  # R_w [m]
    length: float  # L [m]
    mass: float  # m_r [kg]
    inertia: float  # J_r about its own axis [kg m^2]


class Raceways(NamedTuple):
    """Both raceways and the contact on them."""

    inner_radius: float  # R_i [m]
    low_radius: float  # R_low [m]
    pitch_radius: float  # r_m = R_i + R_w [m]
    diameter_ratio: float  # gamma = D_w / d_m
    contour: np.ndarray  # R_e(phi), periodic cubic table, shape (n, 4)
    contour_dip: float  # lowest radius of the contour less R_low, at most 0 [m]
    stiffness: float  # K of Q = K delta^(10/9) [N/m^(10/9)]
    damping: ContactDamping
    inner_curvature_radius: float  # effective radius of the inner contact [m]
    outer_curvature_radius: float  # effective radius of the outer contact [m]
    reduced_modulus: float  # E' = 2 / sum((1 - nu^2)/E) [Pa]
    profile: Profile  # of the rollers, at the levels where they stay aligned


class Guidance(NamedTuple):
    """What guides the cage: lands of a ring, or pockets that hold the rollers outwards and inwards too."""

    lands: bool  # whether lands guide it
    turning: float  # 1 where they are the inner ring's, which turns and moves, else 0
    pocket_radius: float  # of guiding pockets' middles, where rollers on the outer raceway are in the mean [m]


class CageBody(NamedTuple):
    """The cage."""

    inertia: float  # about the shaft axis [kg m^2]
    mass: float  # [kg]
    pocket_friction: float  # mu_c, on a full film
    assumed_eccentricity: float  # of the cage at level slip, over the guide clearance
    pocket_clearance: float  # C_p [m]
    pocket_stiffness: float  # K_c of the film, until the clearance is used up [N/m]
    pocket_damping: float  # of the film [N s/m]
    guidance: Guidance
    guide_radius: float  # R_g [m]
    guide_clearance: float  # c [m]; without lands the radial play of the pockets
    guide_width: float  # L_g, all lands together [m]; 0 without lands
    land_film: float  # films in the guide land thinner than this touch [m]
    land_friction: float  # coefficient of boundary friction there
    land_vortices: bool  # whether vortices and turbulence in their films count
    outer_radius: float  # of the cage [m]
    inner_radius: float  # of the cage [m]
    outer_width: float  # of its outer surface, without what runs on lands [m]
    inner_width: float  # of its bore, likewise [m]


class SupportNumber(NamedTuple):
    """Where each number of what carries the bearing stands in ``Params.support``, see `bearing_sim.levels.common.support`.

    What does not move has mass 1 and neither spring nor damper.
    """

    active: int = 0  # 1 where any of this is there
    shaft_bends: int = 1  # 1 where the shaft's mass is a body of its own behind a spring, 0 where it moves with the inner ring
    outer_moves: int = 2  # 1 where the outer ring is a body on springs, 0 where it is held
    shaft_mass: int = 3  # [kg]
    shaft_stiffness: int = 4  # y and z [N/m]
    shaft_damping: int = 6  # y and z [N s/m]
    outer_mass: int = 8
    outer_stiffness: int = 9
    outer_damping: int = 11
    film_geometry: int = 13  # of `bearing_sim.physics.squeeze_film.SqueezeFilm`
    film_clearance: int = 14
    unbalance: int = 15  # m e [kg m]
    unbalance_angle: int = 16  # of the eccentricity before the shaft's angle [rad]


SUPPORT = SupportNumber()


class Ring(NamedTuple):
    """The inner ring and what moves with it."""

    mass: float  # [kg]


SLICED_EQUALLY, STRAIGHT, LOGARITHMIC, STRAIGHT_ARC = range(4)  # how contacts in motion are evaluated: equal slices, or a quadrature by profile


class Slices(NamedTuple):
    """Where along the rollers contacts are evaluated; only level ``spatial`` and the statics by slices use it."""

    profile: int  # `SLICED_EQUALLY`, or the profile of which a quadrature is taken
    points: int  # of a contact in motion
    positions: np.ndarray  # axial position of each slice's middle from the roller's, x_k [m], shape (N,)
    crown: np.ndarray  # drop of the profile there, C_k [m], shape (N,)
    walls: np.ndarray  # axial positions of the slices that meet a pocket's walls [m]
    half_length: float  # L/2 [m]
    scale: float  # of the logarithmic profile, 0.00035 D_w, or radius of the arcs [m]
    straight: float  # where the arcs begin, over L/2
    abscissae: np.ndarray  # of the quadrature, from -1 to 1 of the loaded part, shape (points,)
    weights: np.ndarray  # fraction of the loaded part that each stands for


class Tilts(NamedTuple):
    """What tilts and what tilts it; only level ``spatial`` uses it.

    Tilts and moments are pairs by y and z: a tilt is the inclination of the axis towards them, a moment is what drives it.
    """

    roller_inertia: float  # about a diameter [kg m^2]
    cage_inertia: float
    ring_inertia: float
    ring_polar_inertia: float  # [kg m^2]
    land_position: float  # of one of the cage's guide lands along the axis, the other is opposite [m]
    ring_free: float  # 1 where a moment tilts the ring, 0 where its tilt is held
    moment_y: float  # on the ring [N m]
    moment_z: float
    misalignment_y: float  # where the ring begins, and stays where it is held [rad]
    misalignment_z: float


class Envelope(NamedTuple):
    """Boundary dimensions of the bearing, and its seals."""

    bore_diameter: float  # d [m]
    outside_diameter: float  # D [m]
    width: float  # B [m]
    seal_moment: float  # frictional moment of the seals on the shaft [N m]


class Life(NamedTuple):
    """Load ratings of the bearing (ISO 281, ISO 76) and of one roller contact (ISO/TS 16281), and what modifies the life (ISO 281)."""

    method: int  # of `bearing_sim.physics.rating_life.METHODS`
    dynamic_rating: float  # C [N]
    static_rating: float  # C_0 [N]
    fatigue_limit: float  # C_u [N]
    inner_rating: float  # Q_ci [N]
    outer_rating: float  # Q_ce [N]
    reliability_factor: float  # a_1
    modified: bool  # whether a_ISO is taken
    cleanliness_slope: float  # of e_C, see `bearing_sim.physics.rating_life.CLEANLINESS`
    cleanliness_loss: float
    laminae: Laminae
    axial_load: float  # |F_a| [N], which flanges carry
    axial_limit: float  # e: up to F_a = e F_r the axial load does not count
    radial_factor: float  # X and Y of P = X F_r + Y F_a above, see `bearing_sim.scene.axial_load`
    axial_factor: float


class Variants(NamedTuple):
    """Where the model departs from Deng 2017, which is 0 throughout; factors 0 or 1."""

    contour_slope: float  # the outer contact's normal leans by the slope of the contour
    land_squeeze: float  # the film of the guide lands depends on the motion of the cage's centre
    pocket_reaction: float  # at level slip pocket friction acts back on the cage
    gyroscopic: float  # gyroscopic moments of tilting rollers, cage and ring


class Params(NamedTuple):
    """Everything about the bearing that does not change while it runs."""

    rollers: Rollers
    raceways: Raceways
    cage: CageBody
    ring: Ring
    life: Life
    mounted: Mounted  # what the clearance of the running bearing follows from
    slices: Slices
    tilts: Tilts
    support: np.ndarray  # what carries the bearing, numbers `SUPPORT`
    variants: Variants
    envelope: Envelope
    flanges: Flanges
    minimum_load: MinimumLoad
    starvation: Starvation
    mixed: MixedFriction
    outer_ring: ElasticRing | None  # where it bends; None: it is rigid


class Lubrication(NamedTuple):
    """What the oil does at its present temperature."""

    inner: TractionConstants  # of roller and inner raceway
    outer: TractionConstants  # of roller and outer raceway
    viscosity: float  # eta_0 of the oil [Pa s]
    density: float  # of the oil [kg/m^3]
    mixture_density: float  # of the oil-air mixture at most [kg/m^3], see `bearing_sim.physics.drag.mixture_density`
    mixture_flow: float  # that density times the shaft's speed [kg rad/(m^3 s)], infinite where the speed does not matter
    temperature: float  # of the oil [K]
    rolling_resistance: RollingResistance
    bath: Bath  # drag of an oil bath on the rollers, zero without one
    growth: Growth  # of the inner raceway by fits, rotation and heat
    kinematic_viscosity: float  # nu of the oil in the films, for the life [m^2/s]
    film_temperature: float  # mean of the films of both raceways [K]


def contact_stiffness(bearing: Bearing) -> float:
    """Return K of Q = K delta^(10/9) [N/m^(10/9)] of one contact, by the scene's spring constant."""
    if bearing.contact.spring == "iso":
        return iso_contact_stiffness(bearing.roller.length)
    return line_contact_stiffness(bearing.roller.length, bearing.material.youngs_modulus, bearing.material.poisson_ratio)


def pack(scene: Scene) -> Params:
    """Return the parameters of a scene as compiled code needs them: float64, int, C-contiguous arrays."""
    bearing = scene.bearing
    roller_radius = bearing.roller.diameter / 2
    mass = math.pi * roller_radius**2 * bearing.roller.length * bearing.material.density
    inner_radius, low_radius = bearing.inner_raceway.radius, bearing.outer_raceway.low_radius
    compliance = 2 * (1 - bearing.material.poisson_ratio**2) / bearing.material.youngs_modulus
    cage = bearing.cage
    land_width = 2 * cage.guide_land_width if cage.has_lands else 0.0
    contour = tabulated(lambda azimuth: outer_contour(bearing.outer_raceway, azimuth))
    return Params(
        rollers=Rollers(
            count=int(bearing.roller.count),
            radius=roller_radius,
            length=bearing.roller.length,
            mass=mass,
            inertia=0.5 * mass * roller_radius**2,
        ),
        raceways=Raceways(
            inner_radius=inner_radius,
            low_radius=low_radius,
            pitch_radius=bearing.pitch_radius,
            diameter_ratio=bearing.diameter_ratio,
            contour=contour,
            contour_dip=min(0.0, float(contour[:, 3].min()) - low_radius),
            stiffness=contact_stiffness(bearing),
            damping=ContactDamping(bearing.contact.damping, bearing.contact.damping_time, bearing.contact.damping_depth),
            inner_curvature_radius=1 / (1 / roller_radius + 1 / inner_radius),
            outer_curvature_radius=1 / (1 / roller_radius - 1 / low_radius),
            reduced_modulus=2 / compliance,
            profile=_profile(bearing.roller.profile, bearing.roller.diameter, bearing.roller.length),
        ),
        cage=CageBody(
            inertia=cage.polar_inertia if cage.polar_inertia is not None else cage.mass * bearing.pitch_radius**2,
            mass=cage.mass,
            pocket_friction=cage.pocket_friction,
            assumed_eccentricity=cage.assumed_eccentricity,
            pocket_clearance=cage.pocket_clearance,
            pocket_stiffness=cage.pocket_film_force / cage.pocket_clearance,
            pocket_damping=cage.pocket_film_damping,
            guidance=Guidance(
                lands=cage.has_lands,
                turning=1.0 if cage.guidance == "inner_ring" else 0.0,
                pocket_radius=float(contour[:, 3].mean()) - roller_radius,
            ),
            guide_radius=cage.land_radius if cage.has_lands else bearing.pitch_radius,
            guide_clearance=running_play(bearing, scene.mounting, scene.operating.shaft_speed),
            guide_width=land_width,
            land_film=cage.land_film,
            land_friction=cage.land_friction,
            land_vortices=cage.land_vortices,
            outer_radius=cage.outside,
            inner_radius=cage.bore,
            outer_width=cage.width - (land_width if cage.guidance == "outer_ring" else 0.0),
            inner_width=cage.width - (land_width if cage.guidance == "inner_ring" else 0.0),
        ),
        ring=Ring(bearing.inner_raceway.ring_mass + (0.0 if scene.support.shaft_bends else scene.support.shaft.mass)),
        life=_life(scene),
        mounted=mounted(bearing, scene.mounting),
        slices=_slices(bearing),
        tilts=_tilts(scene, mass),
        support=_support(scene),
        variants=Variants(
            contour_slope=float(bearing.outer_raceway.contour_slope),
            land_squeeze=float(cage.land_squeeze),
            pocket_reaction=float(cage.pocket_reaction),
            gyroscopic=float(scene.dynamics.gyroscopic),
        ),
        envelope=Envelope(bearing.bore_diameter, bearing.outside_diameter, bearing.boundary_width, bearing.seal_moment),
        flanges=_flanges(scene),
        minimum_load=MinimumLoad(*minimum_load_law(bearing)[:2]),
        starvation=_starvation(scene),
        mixed=_mixed(scene),
        outer_ring=_outer_ring(scene),
    )


def ring_section(bearing: Bearing) -> RingSection:
    """Return the section of the outer ring of a bearing as the laws of an elastic ring take it."""
    section, material = ring_geometry(bearing), bearing.material
    shear = 0.5 * material.youngs_modulus / (1.0 + material.poisson_ratio) if bearing.outer_ring.shear else math.inf
    return RingSection(section.radius, section.second_moment, section.area, material.youngs_modulus, shear)


def _outer_ring(scene: Scene) -> ElasticRing | None:
    """Return the elastic outer ring and its seat; None where it is rigid."""
    if not scene.outer_ring_bends:
        return None
    bearing, housing = scene.bearing, scene.mounting.housing
    backing, section, ring = housing.backing, ring_geometry(bearing), ring_section(bearing)
    if backing.law == "free":
        return new_elastic_ring(ring, None, bearing.roller.count, bearing.outer_ring.points)

    def compliances(n):
        if backing.law == "bed":
            return bed_compliance(n, backing.stiffness)
        if backing.law == "rigid_bore":
            return np.zeros(len(n))
        outside = math.inf if backing.massive else housing.outside_radius
        return bore_compliance(n, section.seat_radius, housing.material.youngs_modulus, housing.material.poisson_ratio, outside)

    def bore(azimuths):
        return sum((wave.amplitude * np.cos(wave.waves * (azimuths - wave.azimuth)) for wave in backing.bore_waves), 0.0 * azimuths)

    around = 2.0 * math.pi * section.seat_radius * section.width
    shrunk = around * float(ring_compliance(0, ring))
    seat = Seat(
        radius=section.seat_radius,
        width=section.width,
        compliances=compliances,
        bore=bore,
        play=math.nan if backing.play is None else backing.play,
        loose=seat_compliance(bearing, scene.mounting) if backing.play is None else 0.0,
        pressed=shrunk + float(compliances(np.zeros(1, int))[0]),
        shrunk=shrunk,
        radial=0.0 if backing.law == "bed" or backing.radial_stiffness is None else 1.0 / backing.radial_stiffness,
    )
    return new_elastic_ring(ring, seat, bearing.roller.count, bearing.outer_ring.points)


@functools.lru_cache(maxsize=64)
def _profile(crown, diameter: float, length: float) -> Profile:
    """Return what a profile does to aligned rollers; a sweep asks for the same one at every point."""
    return new_profile(lambda slices: crown_drops(crown, diameter, length, slices))


def _flanges(scene: Scene) -> Flanges:
    bearing = scene.bearing
    given, roller, size = bearing.flanges, bearing.roller, flange_geometry(bearing)
    rim = 0.5 * roller.diameter - size.corner_radius
    load = abs(scene.operating.axial_load)
    half, layback = 0.5 * size.end_clearance, math.tan(given.opening_angle)
    contact = rim if given.end_radius is None else given.end_radius * math.sin(given.opening_angle)
    raceways = (
        (given.inner, bearing.inner_raceway.radius, size.inner_radius, bearing.pitch_radius),
        (given.outer, bearing.outer_raceway.low_radius, size.outer_radius, bearing.outer_raceway.low_radius - 0.5 * roller.diameter),
    )
    faces = []
    for sides, raceway, edge, centre in raceways:
        # an axial load presses a roller on one flange of each ring, and leaves all the clearance to the other one
        gaps = (given.film, size.end_clearance) if load > 0.0 else (half, half)
        faces.append(flange_face(sides, gaps if sides == "both" else gaps[:1], raceway, edge, centre, rim, layback, contact))
    inner, outer = faces if given.present else (NO_FACE, NO_FACE)
    return Flanges(
        on=given.present,
        guide="both" in (given.inner, given.outer),
        inner=inner,
        outer=outer,
        pitch_radius=bearing.pitch_radius,
        load=load,
        guiding=given.guiding_load,
        couple=math.copysign(1.0, scene.operating.axial_load),
        clearance=half,
        stiffness=corner_stiffness(rim, size.corner_radius, layback, bearing.material.youngs_modulus, bearing.material.poisson_ratio),
        damping=bearing.contact.damping,
        film_friction=given.film_friction,
    )


_SPARSE, _SPARSER = 3e-8, 6e-8  # K_rs of oil jets and low baths, of grease and oil-air, see `bearing_sim.physics.starvation.starvation_rate`


def replenishment(lubricant: Lubricant, roller_radius: float) -> float:
    """Return K_rs of SKF: the scene's, or that of the supply; 0 of contacts that are never starved."""
    law = lubricant.starvation
    if law.law == "none":
        return 0.0
    if law.constant is not None:
        return law.constant
    if lubricant.supply.law in ("oil_air", "grease"):
        return _SPARSER
    return 0.0 if lubricant.has_bath and _bath_level(lubricant, roller_radius) > roller_radius else _SPARSE


def _starvation(scene: Scene) -> Starvation:
    bearing, law = scene.bearing, scene.lubricant.starvation
    rate = starvation_rate(replenishment(scene.lubricant, bearing.roller.diameter / 2), bearing.bore_diameter, bearing.outside_diameter)
    return Starvation(rate, law.law != "none" and law.under_minimum_load == "flooded")


def _free_skew(bearing: Bearing) -> float:
    """Return the skew that flanges and pockets leave a roller [rad]; a bearing without flanges in its scene has some all the same (assumption)."""
    size, radius = flange_geometry(bearing), 0.5 * bearing.roller.diameter
    _, along = rim_corner(size.outer_radius, bearing.outer_raceway.low_radius - radius, radius - size.corner_radius)
    between_flanges = 0.5 * size.end_clearance / along if along > 0.0 else math.inf
    return min(between_flanges, 2.0 * bearing.cage.pocket_clearance / bearing.roller.length)


def _mixed(scene: Scene) -> MixedFriction:
    bearing, law = scene.bearing, scene.lubricant.mixed_friction
    if law.law == "none":
        return MixedFriction(NONE, 0.0, 1.0, 0.0, False, 0.0, bearing.pitch_diameter)
    return MixedFriction(
        law=SKF if law.law == "skf" else FILM_RATIO,
        boundary_friction=law.boundary_friction,
        film_ratio_factor=law.film_ratio_factor,
        skf_constant=skf_constant(0.5 * (bearing.bore_diameter + bearing.outside_diameter)),
        raceways=law.raceways,
        skew=law.skew * _free_skew(bearing),
        pitch_diameter=bearing.pitch_diameter,
    )


# Points on the loaded part of a contact: load and moments err by 0.3 % rms; a profile with kinks needs more for that.
_SMOOTH_POINTS, _KINKED_POINTS = 5, 12
_BALANCE_SLICES = 100  # of statics beside a quadrature
_TABLE_SLICES = 30  # of a profile given by a table, which may bear on several parts
_WALL_SLICES = 20  # that meet the walls of a pocket


def _slices(bearing: Bearing) -> Slices:
    roller = bearing.roller
    profile, scale, straight = SLICED_EQUALLY, 1.0, 1.0
    if roller.slices is None and isinstance(roller.profile, NoCrown):
        profile = STRAIGHT
    elif roller.slices is None and isinstance(roller.profile, IsoLogCrown):
        profile, scale = LOGARITHMIC, log_scale(roller.diameter)
    elif roller.slices is None and isinstance(roller.profile, StraightArcCrown):
        profile, scale, straight = STRAIGHT_ARC, roller.profile.crown_radius, roller.profile.straight_length / roller.length
    count = roller.slices or (_TABLE_SLICES if profile == SLICED_EQUALLY else _BALANCE_SLICES)
    points = _KINKED_POINTS if profile == STRAIGHT_ARC else _SMOOTH_POINTS
    abscissae, weights = np.polynomial.legendre.leggauss(points)
    return Slices(
        profile=profile,
        points=count if profile == SLICED_EQUALLY else points,
        positions=slice_middles(roller.length, count),
        crown=np.ascontiguousarray(crown_drops(roller.profile, roller.diameter, roller.length, count), np.float64),
        walls=slice_middles(roller.length, roller.slices or _WALL_SLICES),
        half_length=roller.length / 2,
        scale=float(scale),
        straight=float(straight),
        abscissae=0.5 * abscissae * (3.0 - abscissae**2),
        weights=0.75 * weights * (1.0 - abscissae**2),
    )


def _tilts(scene: Scene, roller_mass: float) -> Tilts:
    bearing, operating = scene.bearing, scene.operating
    cage, inner = bearing.cage, bearing.inner_raceway
    polar = cage.polar_inertia if cage.polar_inertia is not None else cage.mass * bearing.pitch_radius**2
    ring_polar = inner.polar_inertia if inner.polar_inertia is not None else 0.5 * (inner.ring_mass + scene.support.shaft.mass) * inner.radius**2
    at_edges = cage.width - cage.guide_land_width if cage.has_lands else cage.width
    distance = cage.guide_land_distance if cage.guide_land_distance is not None else at_edges
    moment = operating.moment if operating.moment is not None else 0.0
    return Tilts(
        roller_inertia=roller_mass * (3 * (bearing.roller.diameter / 2) ** 2 + bearing.roller.length**2) / 12,
        cage_inertia=cage.transverse_inertia if cage.transverse_inertia is not None else 0.5 * polar,
        ring_inertia=inner.transverse_inertia if inner.transverse_inertia is not None else 0.5 * ring_polar,
        ring_polar_inertia=ring_polar,
        land_position=distance / 2,
        ring_free=1.0 if operating.moment is not None else 0.0,
        moment_y=moment * math.cos(operating.moment_angle),
        moment_z=moment * math.sin(operating.moment_angle),
        misalignment_y=operating.misalignment * math.cos(operating.misalignment_angle),
        misalignment_z=operating.misalignment * math.sin(operating.misalignment_angle),
    )


def _support(scene: Scene) -> np.ndarray:
    given = scene.support
    settled = settled_support(given, scene.bearing)
    film = settled.outer_ring.squeeze_film if settled.outer_ring is not None else None
    packed = SqueezeFilm(0.0, 1.0) if film is None else new_squeeze_film(film.radius, film.length, film.clearance, film.cavitates)
    shaft, outer_ring = _mount(settled.shaft if given.shaft_bends else None), _mount(settled.outer_ring)
    moving = given.is_active, given.shaft_bends, given.outer_ring_moves
    return np.array([*moving, *shaft, *outer_ring, *packed, given.unbalance.amount, given.unbalance.angle], float)


def _mount(body) -> tuple[float, float, float, float, float]:
    """Return mass, stiffness along y and z, damping along y and z."""
    return (1.0, 0.0, 0.0, 0.0, 0.0) if body is None else (body.mass, body.stiffness, body.stiffness_z, body.damping, body.damping_z)


def _life(scene: Scene) -> Life:
    bearing, choice = scene.bearing, scene.life
    roller, rated = bearing.roller, rate(bearing)
    slope, loss = cleanliness(choice.a_iso, bearing.pitch_diameter)
    inner_rating, outer_rating = ring_ratings(rated.dynamic, roller.count, bearing.diameter_ratio)
    law = equivalent_load_law(bearing)
    return Life(
        method=METHODS[choice.method],
        dynamic_rating=rated.dynamic,
        static_rating=rated.static,
        fatigue_limit=rated.fatigue_limit,
        inner_rating=inner_rating,
        outer_rating=outer_rating,
        reliability_factor=reliability_factor(choice.reliability),
        modified=choice.a_iso != "none",
        cleanliness_slope=slope,
        cleanliness_loss=loss,
        laminae=_laminae(roller, choice.laminae, contact_stiffness(bearing), inner_rating, outer_rating),
        axial_load=abs(scene.operating.axial_load),
        axial_limit=law.limit,
        radial_factor=law.radial_factor,
        axial_factor=law.axial_factor,
    )


@functools.lru_cache(maxsize=64)
def _laminae(roller: Roller, count: int, stiffness: float, inner_rating: float, outer_rating: float) -> Laminae:
    """Return the laminae of a roller; a sweep asks for the same ones at every point, and their table takes longer than all other parameters."""
    positions, drops = slice_middles(roller.length, count), crown_drops(roller.profile, roller.diameter, roller.length, count)
    return new_laminae(positions, drops, stiffness, inner_rating, outer_rating, roller.count)


def lubricate(lubricant: Lubricant, params: Params, temperature: float, temperatures: Temperatures | None = None) -> Lubrication:
    """Return what the lubricant does, and how far the bearing has grown, at given temperatures.

    *Assumptions*: the film of a contact has the mean temperature of the two surfaces; the oil-air mixture has the oil's temperature, the
    mixture fraction times its density, and its viscosity.

    Parameters
    ----------
    lubricant : of the scene.
    params : of the bearing.
    temperature : of the oil [K].
    temperatures : of rings, rollers, shaft and housing; the oil's where absent.
    """
    oil = oil_at(lubricant.oil, temperature)
    solids = uniform(temperature) if temperatures is None else temperatures
    raceways, length = params.raceways, params.rollers.length
    radii = raceways.inner_curvature_radius, raceways.outer_curvature_radius
    films = [oil if temperatures is None else oil_at(lubricant.oil, 0.5 * (ring + solids.rollers)) for ring in (solids.inner_ring, solids.outer_ring)]
    inner, outer = (_traction_constants(lubricant, film, radius, raceways.reduced_modulus, length) for film, radius in zip(films, radii))
    by_flow = lubricant.mixture_fraction is None
    return Lubrication(
        inner=inner,
        outer=outer,
        viscosity=oil.viscosity,
        density=oil.density,
        mixture_density=oil.density * (LARGEST_FRACTION if by_flow else lubricant.mixture_fraction),
        mixture_flow=oil.density * swept_fraction(lubricant.flow, 2.0 * raceways.pitch_radius) if by_flow else math.inf,
        temperature=oil.temperature,
        rolling_resistance=_rolling_resistance(lubricant, params, films),
        bath=_bath(lubricant, params, oil),
        growth=growth_at(params.mounted, solids),
        kinematic_viscosity=sum(film.viscosity / film.density for film in films) / 2,
        film_temperature=0.5 * (films[0].temperature + films[1].temperature),
    )


def mixture_fraction(lubricant: Lubricant, pitch_diameter: float, shaft_speed):
    """Return the fraction of oil in the oil-air mixture: the scene's, that of its kind of supply, or by the flow of a jet.

    Parameters
    ----------
    lubricant : of the scene.
    pitch_diameter : of the bearing [m].
    shaft_speed : [rad/s], a number or an array.
    """
    if lubricant.mixture_fraction is not None:
        return lubricant.mixture_fraction
    return np.minimum(LARGEST_FRACTION, swept_fraction(lubricant.flow, pitch_diameter) / np.maximum(np.abs(shaft_speed), 1e-9))


_JET_DRAG = 2.0  # drag of circulating oil over that of a bath, see `bearing_sim.physics.drag.bath_moment`


def _rolling_resistance(lubricant, params, films) -> RollingResistance:
    """Return the constants of both kinds of contact by the lubricant's law, from the state of the oil in each kind's films."""
    law, mixed, raceways, length = lubricant.rolling_resistance, lubricant.mixed_friction, params.raceways, params.rollers.length
    hydrodynamic, constants = isinstance(law, HydrodynamicRollingResistance), []
    for film, radius in zip(films, (raceways.inner_curvature_radius, raceways.outer_curvature_radius)):
        hysteresis = 0.0 if mixed.law == "none" else hysteresis_constant(mixed.hysteresis, radius, raceways.reduced_modulus, length)
        heated = hydrodynamic and law.inlet_heating
        constants.append(resistance_constants(film, raceways.reduced_modulus, radius, length, heated, hysteresis))
    return RollingResistance(int(hydrodynamic or mixed.law != "none"), float(hydrodynamic), *constants)


def _bath_level(lubricant, roller_radius) -> float:
    """Return the level of the oil bath above the lowest point of the outer raceway [m]."""
    return roller_radius if lubricant.supply.level is None else lubricant.supply.level


def _bath(lubricant, params, oil) -> Bath:
    """Return the drag of the oil bath, if there is one."""
    if not lubricant.has_bath:
        return Bath(0.0, 0.0)
    envelope = params.envelope
    boundary = envelope.bore_diameter, envelope.outside_diameter, envelope.width
    factor = _JET_DRAG if lubricant.supply.law == "circulating" else 1.0
    return bath_drag(_bath_level(lubricant, params.rollers.radius), oil.viscosity / oil.density, params.rollers, params.raceways, *boundary, factor)


def _traction_constants(lubricant, oil, curvature_radius, reduced_modulus, length) -> TractionConstants:
    """Return the constants of one contact by the lubricant's law."""
    law, scale = lubricant.traction, lubricant.traction_scale
    if isinstance(law, ConstantTraction):
        return constant_constants(scale, law.b, law.c, law.d)
    if isinstance(law, KragelskiiTraction):
        return kragelskii_constants(scale, law.mu_0, law.mu_max, law.v_max, law.mu_inf, law.rise_speed)
    if isinstance(law, EyringTraction):
        stress, ratio = shear_strength(lubricant.oil.base, oil.temperature)
        stress, ratio = stress if law.eyring_stress is None else law.eyring_stress, ratio if law.limiting_ratio is None else law.limiting_ratio
        index = pressure_index(lubricant.oil) if law.pressure_index is None else law.pressure_index
        return thermal_eyring_constants(scale, oil, curvature_radius, reduced_modulus, length, stress, ratio, index)
    return oil_4109_constants(scale, oil, curvature_radius, reduced_modulus)
