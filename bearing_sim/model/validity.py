# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Limits of validity: where each law of the model holds, and what to use beyond.

The limits are data beside the laws, ``physics/limits.toml``: the quantity, its range, where the range comes from (or the word *assumption*) and
what to use instead.  An entry of `LAWS` adds which scenes use the law, how the quantity follows from a scene and its samples, and what to compute
otherwise to see what it does.  A result outside a range is still computed, but it carries an exceedance: `outside` finds them all,
`bearing_sim.sweep.grading` says by how much each moves slip, life, power and film, the command line prints those that move one of them, and
`bearing_sim.watchers.monitoring.limits` turns all into events.  A new limit is one entry in each, and one case in ``test/test_validity.py``.

Some limits are judged by more than a scene and its samples, such as by what is kept of a table on disk.  Who knows it passes laws that
replace those of the same name (see `sample_laws`).
"""

import functools
import math
import tomllib
from collections.abc import Callable, Iterable, Sequence
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.model.films import starvation_exponents
from bearing_sim.model.oil import OilState, oil_at, viscosity_100
from bearing_sim.model.params import Params, mixture_fraction, pack
from bearing_sim.model.running_clearance import largest_hoop_stress, mounted, seat_pressure, sleeve_pressure
from bearing_sim.model.sample import new_block, part_temperature
from bearing_sim.model.table_span import Span, span_of
from bearing_sim.model.temperatures import film_temperatures, given_temperatures
from bearing_sim.model.turning import turns
from bearing_sim.physics.film import DOWSON_TOYODA
from bearing_sim.scene.axial_load import heat_limits, strength_limit
from bearing_sim.scene.bearing import Bearing
from bearing_sim.scene.crown import NoCrown
from bearing_sim.scene.designation import readable_designation
from bearing_sim.scene.display import number, unit_sign
from bearing_sim.scene.flanges import flange_geometry
from bearing_sim.scene.lubricant import ConstantTraction, CustomOil, EyringTraction, KragelskiiTraction, Oil, Oil4109Traction
from bearing_sim.scene.outer_ring import ring_geometry
from bearing_sim.scene.ratings import minimum_load_law, rate
from bearing_sim.scene.scene import Scene

ZERO_CELSIUS = 273.15  # [K]
_LOADED_FROM = 1.0  # [N] a contact that carries less takes no part
_SAME_OIL = 0.5  # [K] samples whose oil differs by less share its properties; viscosity then errs by 2 % at most
_OIL_TEMPERATURES = (220.0, 600.0)  # [K] bounds of `lubricant.temperature`, within which the fits of oils give numbers
_VISCOSITY_CLASS_AT = 100.0 + ZERO_CELSIUS  # [K] temperature at which turbine oils are classed
_LOCAL = ("inner_ring_temperature", "roller_temperature", "outer_ring_temperature", "oil_outlet_temperature")
_GREASE_VISCOSITY_AT = 40.0 + ZERO_CELSIUS  # [K] temperature at which base oils are classed
_AIR_VISCOSITY = 1.8e-5  # [m^2/s] of air at 50 degC
_EXTRAPOLATED = 60.0  # [K] beyond the two viscosities of a custom oil
_SEPARATOR = "; "  # of exceedances in a cell of a table
_SMALL_FRACTION = 0.1  # of the losses that brake the cage: one that stays below it decides nothing
_ELASTIC_EXPONENTS = 0.75 - 0.658  # of speed, Biboulet and Houpert's elastic asymptote over that of the law in use, see the theory of film
_MARTIN_COUETTE, _RIGID_THICKENED, _ELASTIC_EVEN, _ELASTIC_THICKENED = 3.0, 1.287, 2.621, 1.311  # of `film_of_all_regimes`


def speed_factor(bearing: Bearing, shaft_speed):
    """Return n d_m in rpm mm of a shaft speed [rad/s]."""
    return np.abs(shaft_speed) * (30.0 / math.pi) * 1e3 * bearing.pitch_diameter


def vortex_factor(taylor):
    """Return the torque between cylinders with Taylor's vortices over that of laminar flow: 1.3 (Ta/41)^0.539 above Ta = 41."""
    return np.maximum(1.3 * (np.asarray(taylor) / 41.0) ** 0.539, 1.0)


def heated_shear(nahme):
    """Return the shear stress of oil that heats itself between walls of one temperature over that of oil that does not.

    arsinh(x)/(x sqrt(1 + x^2)) with x^2 = Na/8 and the viscosity exp(-beta T): exact (R. Nahme, Ing.-Arch. 11 (1940) 191; not read); 0.92 at Na = 1.
    """
    root = np.sqrt(np.maximum(nahme, 1e-12) / 8.0)
    return np.arcsinh(root) / (root * np.sqrt(1.0 + root**2))


def film_of_all_regimes(speed, material, load):
    """Return H = h/R in the middle of a line contact, whether it is rigid or elastic, and whether its oil thickens under pressure or not.

    H. Moes, as secondary literature gives it; its rigid and isoviscous asymptote is Martin's film where the flow is that of shear alone.

    Parameters
    ----------
    speed, material, load : U = eta_0 u/(E' R), G = alpha E', W = Q/(E' R L).
    """
    root = np.sqrt(2.0 * speed)
    loads, thickening = load / root, material * np.sqrt(root)
    rigid, elastic = _MARTIN_COUETTE / loads, _ELASTIC_EVEN * loads**-0.2
    rigid_thickened, elastic_thickened = _RIGID_THICKENED * thickening ** (2 / 3), _ELASTIC_THICKENED * loads**-0.125 * thickening**0.75
    sharpness = (7.0 + 8.0 * np.exp(-2.0 * elastic / rigid)) / 5.0
    even = (rigid ** (7 / 3) + elastic ** (7 / 3)) ** (3 / 7)
    thickened = (rigid_thickened**-3.5 + elastic_thickened**-3.5) ** (-2 / 7)
    return root * (even**sharpness + thickened**sharpness) ** (1.0 / sharpness)


class ContactSpeeds(NamedTuple):
    """Surface speeds in the contacts of one ring [m/s], arrays of one shape."""

    rolling: np.ndarray  # u, mean speed of both surfaces relative to the contact
    sliding: np.ndarray  # du, raceway less roller


def contact_speeds(samples: np.ndarray, params: Params) -> tuple[ContactSpeeds, ContactSpeeds]:
    """Return the surface speeds in the contacts of all rollers with inner and outer raceway, shape (n, Z) each.

    Spins that a sample does not hold are those of rolling on the outer ring.

    Parameters
    ----------
    samples : shape (n,), see `bearing_sim.model.sample`.
    params : of the bearing.
    """
    raceways, radius = params.raceways, params.rollers.radius
    orbit, orbital, spin = samples["roller_radius"], samples["orbital_speed"], samples["roller_spin"]
    surface, shaft = np.where(np.isnan(spin), orbital * orbit / radius, spin) * radius, samples["shaft_speed"][:, None]
    rolled = surface + orbital * radius  # the roller's surface, seen from the contact
    inner = ContactSpeeds(0.5 * ((shaft - orbital) * raceways.inner_radius + rolled), shaft * raceways.inner_radius - orbital * orbit - surface)
    outer = ContactSpeeds(0.5 * (orbital * (orbit + radius) + rolled), surface - orbital * orbit)
    return inner, outer


@functools.lru_cache(maxsize=4096)
def _oil_state(oil: Oil | CustomOil, temperature: float) -> OilState:
    return oil_at(oil, temperature)


class Conditions:
    """What laws are evaluated at in samples of a scene; each quantity is computed when a law first asks for it.

    All quantities have the shape (n,).  They are NaN where nothing is judged: while the shaft turns slower than
    ``thresholds.slip_from_speed``, or where no roller is loaded.

    Parameters
    ----------
    scene : of the samples.
    samples : shape (n,), see `bearing_sim.model.sample`.
    params : of the scene, if they are known.
    """

    def __init__(self, scene: Scene, samples: np.ndarray, params: Params | None = None):
        self.scene, self.samples = scene, samples
        self.params = pack(scene) if params is None else params

    @functools.cached_property
    def turning(self) -> np.ndarray:
        """Whether the shaft turns fast enough to be judged."""
        return turns(self.samples["shaft_speed"], self.scene.thresholds.slip_from_speed)

    def while_turning(self, values: np.ndarray) -> np.ndarray:
        """Return values, NaN where the shaft does not turn."""
        return np.where(self.turning, values, np.nan)

    def while_running(self, values: np.ndarray) -> np.ndarray:
        """Return values, NaN where the shaft turns neither fast enough for slip nor at half its operating speed: thin films are of slow shafts."""
        least = min(self.scene.thresholds.slip_from_speed, 0.5 * abs(self.scene.operating.shaft_speed))
        return np.where(turns(self.samples["shaft_speed"], least), values, np.nan)

    def _oils_at(self, temperatures: np.ndarray) -> tuple[np.ndarray, ...]:
        temperatures = np.clip(temperatures, *_OIL_TEMPERATURES)
        if np.ptp(temperatures) > 0.0:
            temperatures = np.round(temperatures / _SAME_OIL) * _SAME_OIL
        kinds, which = np.unique(temperatures, return_inverse=True)
        states = [_oil_state(self.scene.lubricant.oil, float(kind)) for kind in kinds]
        names = ("viscosity", "density", "pressure_viscosity", "temperature_viscosity", "conductivity")
        found = ([getattr(state, name) for state in states] for name in names)
        return tuple(np.array(each)[which.ravel()] for each in found)

    @functools.cached_property
    def _oils(self) -> tuple[np.ndarray, ...]:
        return self._oils_at(part_temperature(self.samples, "oil_outlet_temperature"))

    @functools.cached_property
    def _films(self) -> tuple[np.ndarray, ...]:
        return self._oils_at(0.5 * sum(film_temperatures(self.samples)))

    @property
    def viscosity(self) -> np.ndarray:
        """eta_0 of the oil in the bearing [Pa s]."""
        return self._oils[0]

    @property
    def density(self) -> np.ndarray:
        """Density of the oil in the bearing [kg/m^3]."""
        return self._oils[1]

    @property
    def film_viscosity(self) -> np.ndarray:
        """eta_0 of the oil at the films' mean temperature [Pa s]."""
        return self._films[0]

    @property
    def film_density(self) -> np.ndarray:
        """Density of the oil at the films' mean temperature [kg/m^3]."""
        return self._films[1]

    @property
    def replenishment(self) -> np.ndarray:
        """Factor of SKF by which contacts that little oil flows back to resist rolling less (`bearing_sim.physics.starvation`)."""
        return np.exp(-starvation_exponents(self.samples["shaft_speed"], self.film_viscosity / self.film_density, self.params.starvation))

    @property
    def pressure_viscosity(self) -> np.ndarray:
        """Pressure coefficient of the viscosity at the films' mean temperature, alpha [1/Pa]."""
        return self._films[2]

    @functools.cached_property
    def _heaviest(self) -> tuple[np.ndarray, ...]:
        """Q/R [N/m], R [m], rolling and sliding speed [m/s] of the contact with the largest pressure."""
        raceways = self.params.raceways
        loads = np.concatenate([self.samples["inner_load"], self.samples["outer_load"]], axis=1)
        radii = np.repeat([raceways.inner_curvature_radius, raceways.outer_curvature_radius], loads.shape[1] // 2)
        inner, outer = contact_speeds(self.samples, self.params)
        place = np.argmax(loads / radii, axis=1)[:, None]
        load = np.take_along_axis(loads, place, axis=1)[:, 0]
        radius = radii[place[:, 0]]
        speeds = (np.take_along_axis(np.concatenate(both, axis=1), place, axis=1)[:, 0] for both in zip(inner, outer))
        return np.where(load > _LOADED_FROM, load / radius, np.nan), radius, *speeds

    @functools.cached_property
    def pressure(self) -> np.ndarray:
        """Largest Hertz pressure of any contact [Pa], of a lamina where the level lets rollers tilt."""
        per_length = self._heaviest[0] / self.params.rollers.length
        whole = np.sqrt(per_length * self.params.raceways.reduced_modulus / (2.0 * math.pi))
        return np.fmax(whole, np.maximum(self.samples["inner_pressure"], self.samples["outer_pressure"]))

    @functools.cached_property
    def rolling_speed(self) -> np.ndarray:
        """Rolling speed u of the most heavily loaded contact [m/s]."""
        return self.while_turning(np.where(np.isnan(self._heaviest[0]), np.nan, np.abs(self._heaviest[2])))

    @functools.cached_property
    def slide_to_roll(self) -> np.ndarray:
        """|du|/u of the most heavily loaded contact."""
        return np.abs(self._heaviest[3]) / np.maximum(self.rolling_speed, 1e-9)

    @property
    def film_speed(self) -> np.ndarray:
        """U = eta_0 u/(E' R) of that contact."""
        return self.film_viscosity * self.rolling_speed / (self.params.raceways.reduced_modulus * self._heaviest[1])

    @property
    def film_load(self) -> np.ndarray:
        """W = Q/(E' R L) of that contact."""
        return self.while_turning(self._heaviest[0] / (self.params.raceways.reduced_modulus * self.params.rollers.length))

    @property
    def film_material(self) -> np.ndarray:
        """G = alpha E'."""
        return self.while_turning(self.pressure_viscosity * self.params.raceways.reduced_modulus)

    @property
    def equivalent_load(self) -> np.ndarray:
        """The larger of the radial load and the reference load of ISO/TS 16281, which contains preload and centrifugal forces [N]."""
        return np.fmax(self.samples["equivalent_load"], self.samples["reference_load"])

    @property
    def speed_factor(self) -> np.ndarray:
        """Speed factor n d_m [rpm mm]."""
        return speed_factor(self.scene.bearing, self.samples["shaft_speed"])

    @property
    def radial_load(self) -> np.ndarray:
        """The radial load on the inner ring [N]."""
        return np.hypot(self.samples["load_y"], self.samples["load_z"])

    @functools.cached_property
    def mixture_fraction(self) -> np.ndarray | float:
        """Fraction of oil in the oil-air mixture."""
        return mixture_fraction(self.scene.lubricant, self.scene.bearing.pitch_diameter, self.samples["shaft_speed"])

    @property
    def churning_reynolds(self) -> np.ndarray:
        """Re = rho v D_w/eta of a roller in the oil-air mixture."""
        speed = np.abs(self.samples["cage_speed"]) * self.params.raceways.pitch_radius
        density = self.mixture_fraction * self.density
        return self.while_turning(density * speed * 2.0 * self.params.rollers.radius / self.viscosity)

    @property
    def end_face_reynolds(self) -> np.ndarray:
        """Re = rho omega R^2/eta of the cage's end faces."""
        density = self.mixture_fraction * self.density
        return self.while_turning(density * np.abs(self.samples["cage_speed"]) * self.params.cage.outer_radius**2 / self.viscosity)

    @property
    def _land_sliding(self) -> np.ndarray:
        """Speed of the cage's lands over those of the ring [m/s]."""
        cage, samples = self.params.cage, self.samples
        return np.abs(samples["cage_speed"] - cage.guidance.turning * samples["shaft_speed"]) * cage.guide_radius

    def _where_lands_decide(self, number: np.ndarray, factor: np.ndarray) -> np.ndarray:
        """Return a number; NaN where drag of the lands times a factor differs by less than a tenth of what brakes the cage, or is below it."""
        samples = self.samples
        land, others = samples["land_power"], samples["churning_power"] + samples["windage_power"]
        decides = land * np.abs(factor - 1.0) > _SMALL_FRACTION * (land * np.minimum(factor, 1.0) + others)
        return self.while_turning(np.where(decides, number, np.nan))

    @property
    def land_taylor(self) -> np.ndarray:
        """Taylor number of the oil in the guide lands; NaN where vortices would add less than a tenth of what brakes the cage."""
        cage = self.params.cage
        number = self.density * self._land_sliding * cage.guide_clearance / self.viscosity * math.sqrt(cage.guide_clearance / cage.guide_radius)
        return self._where_lands_decide(number, vortex_factor(number))

    @property
    def land_nahme(self) -> np.ndarray:
        """Nahme-Griffith number beta eta U^2/k of the oil in the guide lands; NaN where its heat takes less than a tenth off what brakes the cage."""
        thinning, conductivity = self._oils[3:]
        number = thinning * self.viscosity * self._land_sliding**2 / conductivity
        return self._where_lands_decide(number, heated_shear(number))


def _flange_speed(at: "Conditions") -> np.ndarray:
    """Return how fast the end of a rolling roller slides over the edge of a flange [m/s]; that of the inner ring is the faster."""
    bearing = at.scene.bearing
    size, ratio = flange_geometry(bearing), bearing.diameter_ratio
    spin = 0.5 * (1.0 - ratio) / ratio
    heights = (
        (size.inner_radius - bearing.inner_raceway.radius) * (spin + 1.0) if bearing.flanges.inner != "none" else 0.0,
        (bearing.outer_raceway.low_radius - size.outer_radius) * spin if bearing.flanges.outer != "none" else 0.0,
    )
    return max(heights) * np.abs(at.samples["shaft_speed"])


def _has_squeeze_film(scene: Scene) -> bool:
    outer = scene.support.outer_ring
    return scene.cage_whirls and outer is not None and outer.squeeze_film is not None


def _has_seat(scene: Scene) -> bool:
    return scene.outer_ring_bends and scene.mounting.housing.backing.law != "free"


_THICK_WITH_SHEAR, _THICK_WITHOUT = 1.0, 0.28  # n t/R up to which the law is within 2.5 %, see the table of limits
_WAVES = 6  # of a raceway that bends between six rollers or lobes, the finest that counts for much (assumption)
_LINE_TO_LINE = ("mounting.housing.fit=null", "mounting.housing.interference=null", "mounting.housing.backing.play=0 um")


def _thickness_of_waves(scene: Scene) -> float:
    """Return n t/R of an outer ring that bends in some waves."""
    section = ring_geometry(scene.bearing)
    return _WAVES * section.equivalent_thickness / section.radius


def _seat_play(at: "Conditions") -> np.ndarray:
    """Return the radial play of the outer ring in its housing [um], negative for an interference."""
    ring, fit, cold = at.params.outer_ring, at.params.mounted.housing, at.params.mounted.expansion.reference
    warmer, around = (part_temperature(at.samples, f"{part}_temperature") - cold for part in ("outer_ring", "housing"))
    pressure = fit.pressure + fit.by_ring * warmer + fit.by_housing * around
    by_fit = np.where(pressure > 0.0, -pressure * ring.pressed, -pressure * ring.loose)
    return 1e6 * (by_fit if math.isnan(ring.play) else ring.play + 0.0 * pressure)


class Grade(StrEnum):
    """How much an exceedance says."""

    WARNING = "warning"  # outside of a law's range, and a printed number moves by more than its band, or how far is not known
    NO_EFFECT = "without effect"  # outside of a law's range, and no printed number moves by more than its band
    ASSUMPTION = "assumption"  # outside of a range that is an assumption, and how far numbers move is not computed


class Bands(NamedTuple):
    """Changes of printed numbers that are as good as none."""

    slip: float = 5e-4  # of cage slip, absolute, to which a run knows it
    slip_ratio: float = 0.02  # the same over the slip, if that is more
    life: float = 0.02  # relative, to which a run knows it
    life_factor: float = 0.05  # the same where the law is one of lives, which by load ratings (L ~ C^(10/3), C to 2 %) are no better known
    power: float = 0.05  # relative; makers' models of friction differ by more
    film: float = 0.2  # relative; by so much formulas for line contacts differ (Dowson and Toyoda, Pan and Hamrock)


BANDS = Bands()


SHOWN = ("slip", "life", "power loss", "film")
"""Numbers that an exceedance may move."""


def _two_digits(value: float) -> str:
    """Return a change with its sign, to two digits, without a power of ten."""
    return f"{value:+.0f}" if abs(value) >= 9.95 else f"{value:+.2g}"


class Effect(NamedTuple):
    """By how much printed numbers move if a scene is computed otherwise."""

    slip: float  # change of cage slip, absolute
    life: float  # relative change of the life that counts, by the scene's method and modified
    power: float  # relative change of the power loss
    film: float  # relative change of the film
    from_slip: float  # the slip as computed
    otherwise: str  # what was computed otherwise, for people
    is_of_life: bool = False  # whether the law is one of lives
    shown: tuple[str, ...] = SHOWN  # which of these numbers somebody reads

    @property
    def _over_bands(self) -> dict[str, float]:
        """Each change in words, over its band."""
        slip_band = max(BANDS.slip, BANDS.slip_ratio * abs(self.from_slip))
        life_band = BANDS.life_factor if self.is_of_life else BANDS.life
        parts = ("life", self.life, life_band), ("power loss", self.power, BANDS.power), ("film", self.film, BANDS.film)
        found = {f"slip by {_two_digits(100.0 * self.slip)} points": abs(self.slip) / slip_band} if "slip" in self.shown else {}
        return found | {f"{name} by {_two_digits(100.0 * change)} %": abs(change) / band for name, change, band in parts if name in self.shown}

    @property
    def size(self) -> float:
        """The largest change over its band."""
        return max(self._over_bands.values())

    @property
    def moved(self) -> list[str]:
        """The printed numbers that move by more than their band, and by how much."""
        return [words for words, change in self._over_bands.items() if change > 1.0]

    @property
    def text(self) -> str:
        """What moves by how much, or that nothing does."""
        if moved := self.moved:
            return f"moves {', '.join(moved)} ({self.otherwise})"
        most = f"slip {100.0 * self.slip:+.1g} points, life {100.0 * self.life:+.1g} %, power loss {100.0 * self.power:+.1g} %"
        return f"moves no printed number ({self.otherwise}: {most})"


PARTS = ("film", "rolling_resistance", "drag", "lands", "viscosity_ratio")
"""Parts of the model that a `Variation` can multiply: films in the contacts, elastic resistance to rolling, drag of mixture and bath, that of the
guide lands, and kappa of the modified life."""


class Variation(NamedTuple):
    """What to compute otherwise to see what it does that a law is outside of its range: a part of the model times a factor, or another scene.

    Attributes
    ----------
    otherwise : what it is, for people.
    factors : by names of `PARTS`; functions of the exceedance and of `Conditions` of one sample; NaN where the effect is not known there.
    overrides : scene fields, each ``FIELD=VALUE``, or a function of the exceedance that returns them.
    """

    otherwise: str
    factors: "dict[str, float | Callable[[Exceedance, Conditions], float]]" = {}
    overrides: "Sequence[str] | Callable[[Exceedance], Sequence[str]]" = ()


def _over_all_regimes(exceedance: "Exceedance", at: Conditions) -> float:
    """Return the film of all regimes over the one in use; of the conditions, whose film is the one that is shown."""
    speed, material, load = at.film_speed[0], at.film_material[0], at.film_load[0]
    law = DOWSON_TOYODA
    return film_of_all_regimes(speed, material, load) / (law.factor * speed**law.speed * material**law.material * load**law.load)


def _held_at_edge(power: float) -> "Callable[[Exceedance, Conditions], float]":
    """Return the factor on what goes with a power of the quantity, if that were held at the end of its range."""
    return lambda exceedance, at: (exceedance.edge / exceedance.value) ** power


_OTHER_FILM = Variation("Moes' film of all regimes", {"film": _over_all_regimes})
_EYRING = Variation("traction by lubricant.traction eyring", overrides=("lubricant.traction=eyring",))
_OTHER_TRACTIONS = (  # assumption: by so much curves of oils of one kind differ
    Variation("twice the traction", overrides=("lubricant.traction_scale=2",)),
    Variation("half the traction", overrides=("lubricant.traction_scale=0.5",)),
)
_FACTOR_OF_TWO = (Variation("twice the drag", {"drag": 2.0}), Variation("half the drag", {"drag": 0.5}))
_NO_JET = Variation("drag as of circulating oil", overrides=("lubricant.supply=circulating", "lubricant.mixture_fraction=null"))


Limit = float | Callable[[Scene], float]


class Law(NamedTuple):
    """One limit of one law.

    Attributes
    ----------
    name : identifier, unique in `LAWS`.
    kind : of its events, ``validity.`` and the subject.
    law : what is evaluated, for people.
    quantity : whose range is limited.
    unit : shown behind the value; values in ``degC`` are kept in kelvin.
    low, high : the range; infinite for none; functions of the scene where it depends on it.
    source : of the range, or the word *assumption* and its reason.
    instead : what to use, or to do, outside.
    applies : whether a scene uses the law.
    value : the quantity; of the scene alone (a number) if ``of_scene``, otherwise of `Conditions` (an array, NaN where nothing is judged).
    of_scene : whether the quantity depends on the scene alone.
    expected : the range in words where it is not two numbers: of a condition that a scene meets (0) or not (1), or that depends on the scene.
    variations : what to compute otherwise to see what an exceedance does, the worst of which counts; none: the effect is not known.
    """

    name: str
    kind: str
    law: str
    quantity: str
    unit: str
    low: Limit
    high: Limit
    source: str
    instead: str
    applies: Callable[[Scene], bool]
    value: Callable
    of_scene: bool = False
    expected: str = ""
    variations: tuple[Variation, ...] = ()

    @property
    def is_assumed(self) -> bool:
        """Whether the range is an assumption."""
        return self.source.startswith("assumption")

    def exceeded(self, value: float, low: float, high: float) -> "Exceedance":
        """Return an exceedance whose effect has not been computed."""
        return Exceedance(self, value, low, high, Grade.ASSUMPTION if self.is_assumed else Grade.WARNING)

    def limits(self, scene: Scene) -> tuple[float, float]:
        """Return the range for a scene."""
        low, high = (limit(scene) if callable(limit) else limit for limit in (self.low, self.high))
        return low, high

    @property
    def is_condition(self) -> bool:
        """Whether the law has a condition instead of a range."""
        return bool(self.expected) and not callable(self.low) and not callable(self.high)

    @property
    def general_range(self) -> str:
        """The range in words, whatever the scene."""
        return self.expected or self.range_text(self.low, self.high)

    def counted_text(self, values: Sequence[float]) -> str:
        """Return the warning for several shown values outside of the range."""
        said = self.statement(*dict.fromkeys(number(value) for value in (min(values), max(values))))
        return f"{self.name}: {self.law}: {said}; expected {self.general_range} ({self.source}); {self.instead}"

    def statement(self, *values: str) -> str:
        """Return the quantity with one or several shown values; a condition has none."""
        return self.quantity if self.is_condition else f"{self.quantity} is {' to '.join(values)} {unit_sign(self.unit)}".rstrip()

    def shown(self, value: float) -> float:
        """Return a value in the unit of the law."""
        return value - ZERO_CELSIUS if self.unit == "degC" else value

    def range_text(self, low: float, high: float) -> str:
        """Return a range in words."""
        if self.is_condition:
            return self.expected
        unit, low, high = f" {unit_sign(self.unit)}".rstrip(), self.shown(low), self.shown(high)
        if math.isinf(low):
            return f"at most {number(high)}{unit}"
        return f"at least {number(low)}{unit}" if math.isinf(high) else f"{number(low)} to {number(high)}{unit}"


class Exceedance(NamedTuple):
    """A law that is applied outside of its range."""

    law: Law
    value: float  # the worst; in kelvin for a temperature
    low: float
    high: float
    grade: Grade = Grade.WARNING
    effect: Effect | None = None  # None: not computed, or not known

    @property
    def edge(self) -> float:
        """The end of the range that is passed."""
        return self.low if self.value < self.low else self.high

    def graded(self, effect: Effect) -> "Exceedance":
        """Return the exceedance with its effect."""
        return self._replace(grade=Grade.WARNING if effect.moved else Grade.NO_EFFECT, effect=effect)

    @property
    def said_effect(self) -> str:
        """What it does, in words."""
        if self.effect is not None:
            return self.effect.text
        return "effect not known" if not self.law.variations else "effect not computed"

    @property
    def finding(self) -> str:
        """What was found and what was expected."""
        return f"{self._statement} ({self.law.source})"

    @property
    def _statement(self) -> str:
        law = self.law
        return f"{law.statement(number(law.shown(self.value)))}; expected {law.range_text(self.low, self.high)}"

    @property
    def text(self) -> str:
        """The exceedance as a sentence: name, law, value, range, source, effect and alternative."""
        return f"{self.law.name}: {self.law.law}: {self.finding}; {self.said_effect}; {self.law.instead}"

    @property
    def note(self) -> str:
        """Grade, name, value, range and effect in a line."""
        return f"{self.grade}: {self.law.name}: {self._statement}; {self.said_effect}"

    @property
    def short(self) -> str:
        """Name and value, for a cell of a table."""
        return self.law.name if self.law.is_condition else f"{self.law.name} {self.law.shown(self.value):.4g} {self.law.unit}".rstrip()

    @property
    def excess(self) -> float:
        """How far outside, in relation to the limit; to find the worst of several."""
        return max(self.low - self.value, self.value - self.high) / max(abs(self.edge), 1e-300)

    def report(self) -> dict[str, object]:
        """Return the fields for JSON."""
        law = self.law
        value, low, high = (None if law.is_condition else law.shown(each) for each in (self.value, self.low, self.high))
        return {
            "name": law.name,
            "law": law.law,
            "quantity": law.quantity,
            "value": value,
            "unit": law.unit,
            "low": low,
            "high": high,
            "expected": law.range_text(self.low, self.high),
            "source": law.source,
            "instead": law.instead,
            "grade": str(self.grade),
            "effect": None if self.effect is None else self.effect._asdict() | {"moved": self.effect.moved},
            "text": self.text,
        }


def _with_traction(*laws: type) -> Callable[[Scene], bool]:
    return lambda scene: isinstance(scene.lubricant.traction, laws)


def _has_bath(scene: Scene) -> bool:
    return scene.lubricant.has_bath


def _has_mixture(scene: Scene) -> bool:
    lubricant = scene.lubricant
    return lubricant.supply.law == "oil_jet" or lubricant.mixture_fraction > 0.0


def _has_given_mixture(scene: Scene) -> bool:
    return _has_mixture(scene) and scene.lubricant.mixture_fraction is not None


def _has_grease(scene: Scene) -> bool:
    return scene.lubricant.grease is not None


def _grease_speed_factor(scene: Scene) -> float:
    """Return the largest n d_m of the scene's grease [rpm mm]: its own, or a usual one of its base oil and consistency."""
    grease, oil = scene.lubricant.grease, scene.lubricant.oil
    if grease.speed_factor is not None:
        return grease.speed_factor
    by_oil = 500e3 if oil.base != "mineral" else 350e3
    return by_oil if oil_at(oil, _GREASE_VISCOSITY_AT).viscosity < 0.25 else 0.5 * by_oil


def _parts_differ_from_oil(scene: Scene) -> float:
    """Return whether rings or rollers are given another temperature than that of the oil, as a number."""
    oil = scene.lubricant.temperature
    parts = given_temperatures(scene.heat, oil)
    return float(any(each != oil for each in (parts.inner_ring, parts.rollers, parts.outer_ring)))


def _by_kind_of_oil(scene: Scene) -> bool:
    oil = scene.lubricant.oil
    return isinstance(oil, CustomOil) and oil.pressure_viscosity is None


def _by_viscosity_index(scene: Scene) -> bool:
    oil = scene.lubricant.oil
    return isinstance(oil, CustomOil) and oil.viscosity_100 is None


def _with_eyring_field(name: str) -> Callable[[Scene], bool]:
    return lambda scene: isinstance(scene.lubricant.traction, EyringTraction) and getattr(scene.lubricant.traction, name) is not None


def _has_film(scene: Scene) -> bool:
    return scene.bearing.roughness is not None or isinstance(scene.lubricant.traction, EyringTraction)


def _has_lands(scene: Scene) -> bool:
    return scene.bearing.cage.has_lands


def _is_cold(scene: Scene) -> bool:
    return scene.bearing.dimensions_at == "cold"


def _has_axial_load(scene: Scene) -> bool:
    return scene.operating.axial_load != 0.0


def _always(scene: Scene) -> bool:
    return True


def _by_laminae(scene: Scene) -> bool:
    return scene.life.method == "iso16281"


def _flange_load_share(at: "Conditions") -> np.ndarray:
    """Return the axial load over the least that limits it all the time, while the shaft turns."""
    scene, samples = at.scene, at.samples
    heat = heat_limits(scene, samples["shaft_speed"], at.radial_load, samples["viscosity_ratio"])
    return at.while_turning(abs(scene.operating.axial_load) / np.maximum(np.fmin(heat, strength_limit(scene.bearing)), 1e-9))


def _share_of_minimum_load(at: "Conditions") -> np.ndarray:
    law = minimum_load_law(at.scene.bearing)
    return at.radial_load / (law.at_rest + law.by_speed * np.abs(at.samples["shaft_speed"]))


def _has_polyamide_cage(scene: Scene) -> bool:
    return not scene.bearing.cage.is_absent and scene.bearing.cage.material.name.startswith("polyamide")


def _stabilised_to(scene: Scene) -> float:
    """Return the temperature to which the rings keep their dimensions [K], by the suffix of the designation (DIN 623-1)."""
    suffixes = readable_designation(scene.bearing.designation).unmodelled
    return _STABILISED.get(next((each for each in suffixes if each in _STABILISED), "SN"), math.inf)


_STABILISED = {name: celsius + ZERO_CELSIUS for name, celsius in {"SN": 120, "S0": 150, "S1": 200, "S2": 250, "S3": 300, "S4": 350}.items()}


def _class_viscosity(scene: Scene) -> float:
    oil = oil_at(scene.lubricant.oil, _VISCOSITY_CLASS_AT)
    return 1e6 * oil.viscosity / oil.density


def _is_sample_curve(scene: Scene) -> float:
    traction = scene.lubricant.traction
    return float(traction == type(traction)())


def _lowest_oil(scene: Scene) -> float:
    oil = scene.lubricant.oil
    return 40.0 + ZERO_CELSIUS - _EXTRAPOLATED if isinstance(oil, CustomOil) else min(oil.density_temperatures)


def _highest_oil(scene: Scene) -> float:
    oil = scene.lubricant.oil
    return 100.0 + ZERO_CELSIUS + _EXTRAPOLATED if isinstance(oil, CustomOil) else max(oil.density_temperatures)


def _widest_gap(scene: Scene) -> float:
    cage, bearing = scene.bearing.cage, scene.bearing
    outer = (bearing.outer_raceway.low_radius - cage.outside) / cage.outside
    return max(outer, (cage.bore - bearing.inner_raceway.radius) / cage.bore)


def _nominal_speed_factor(scene: Scene) -> float:
    return float(speed_factor(scene.bearing, scene.operating.shaft_speed)) if scene.operating.shaft_speed else math.nan


def towards_ends(conditions: Conditions, span: Span | None = None) -> np.ndarray:
    """Return how far operating points are towards the ends of a table of level ``steady``; more than 1 beyond them, NaN at rest.

    Parameters
    ----------
    conditions : of n samples.
    span : what the table spans; what the block ``table`` of the scene says where absent.
    """
    span, samples = span or span_of(conditions.scene), conditions.samples
    middle, half = 0.5 * (span.minimum_temperature + span.maximum_temperature), 0.5 * (span.maximum_temperature - span.minimum_temperature)
    temperature = np.abs(samples["oil_temperature"] - middle) / max(half, _SAME_OIL)
    ratios = np.abs(samples["shaft_speed"]) / span.maximum_speed, conditions.radial_load / span.maximum_load, temperature
    return conditions.while_turning(np.maximum.reduce(ratios))


def _has_corrected_table(scene: Scene) -> bool:
    return scene.level == "steady" and scene.table.correction != "none"


_TABLE = tomllib.loads((Path(__file__).resolve().parents[1] / "physics" / "limits.toml").read_text("utf-8"))


def _law(name: str, applies: Callable[[Scene], bool], value: Callable, *variations: Variation, of_scene=False, low=None, high=None) -> Law:
    """Return the limit of a name in the table of limits; ends of its range that depend on the scene are functions."""
    entry = _TABLE[name]
    offset = ZERO_CELSIUS if entry.get("unit") == "degC" else 0.0
    entry = {"unit": ""} | entry | {"low": low or entry.get("low", -math.inf) + offset, "high": high or entry.get("high", math.inf) + offset}
    return Law(name, **entry, applies=applies, value=value, of_scene=of_scene, variations=variations)


def _is_as_of_jets(fraction: float) -> bool:
    return _TABLE["mixture_fraction"]["low"] <= fraction <= _TABLE["mixture_fraction"]["high"]


LAWS = (
    _law("table_correction", _has_corrected_table, towards_ends),
    # in place of whose quantity comes that of a table: `bearing_sim.watchers.estimation.two_states`
    _law("table_states", _has_corrected_table, lambda at: at.while_turning(np.zeros(len(at.samples)))),
    _law("oil_4109_class", _with_traction(Oil4109Traction), _class_viscosity, _EYRING, of_scene=True),
    _law("oil_4109_base", _with_traction(Oil4109Traction), lambda scene: float(scene.lubricant.oil.base != "aviation"), _EYRING, of_scene=True),
    _law("oil_4109_pressure", _with_traction(Oil4109Traction), lambda at: at.while_turning(1e-9 * at.pressure), *_OTHER_TRACTIONS),
    _law("oil_4109_speed", _with_traction(Oil4109Traction), lambda at: at.rolling_speed, *_OTHER_TRACTIONS),
    _law("oil_4109_temperature", _with_traction(Oil4109Traction), lambda at: at.while_turning(at.samples["oil_temperature"]), *_OTHER_TRACTIONS),
    _law("oil_4109_sliding", _with_traction(Oil4109Traction), lambda at: at.slide_to_roll, *_OTHER_TRACTIONS),
    _law("traction_sample_curve", _with_traction(ConstantTraction, KragelskiiTraction), _is_sample_curve, _EYRING, of_scene=True),
    _law(
        "eyring_stress",
        _with_eyring_field("eyring_stress"),
        lambda scene: 1e-6 * scene.lubricant.traction.eyring_stress,
        Variation("the stress at the end of its range", overrides=lambda each: (f"lubricant.traction.eyring_stress={each.edge} MPa",)),
        of_scene=True,
    ),
    _law(
        "eyring_limiting_stress",
        _with_eyring_field("limiting_ratio"),
        lambda scene: scene.lubricant.traction.limiting_ratio,
        Variation("the ratio at the end of its range", overrides=lambda each: (f"lubricant.traction.limiting_ratio={each.edge}",)),
        of_scene=True,
    ),
    _law("eyring_viscosity", _with_traction(EyringTraction), lambda at: at.while_turning(1e3 * at.viscosity)),
    _law("film_speed", _has_film, lambda at: at.film_speed, _OTHER_FILM),
    _law("film_load", _has_film, lambda at: at.film_load, _OTHER_FILM),
    _law("film_material", _has_film, lambda at: at.film_material, _OTHER_FILM),
    _law(
        "rolling_speed",
        lambda scene: scene.lubricant.rolling_resistance.law != "none",
        lambda at: 2.0 * at.film_speed,
        Variation(
            "Biboulet and Houpert's elastic resistance, equal at the end of the range",
            {"rolling_resistance": _held_at_edge(-_ELASTIC_EXPONENTS)},
        ),
    ),
    _law("bath_viscosity", _has_bath, lambda at: at.while_turning(1e6 * at.viscosity / at.density), *_FACTOR_OF_TWO),
    _law(
        "bath_speed",
        lambda scene: _has_bath(scene) and scene.bearing.ratings.reference_speed is not None,
        lambda at: np.abs(at.samples["shaft_speed"]) / at.scene.bearing.ratings.reference_speed,
        Variation("drag as at the reference speed", {"drag": _held_at_edge(2.0)}),
    ),
    _law(
        "mixture_fraction",
        _has_given_mixture,
        lambda scene: scene.lubricant.mixture_fraction,
        Variation("the fraction at the end of its range", overrides=lambda each: (f"lubricant.mixture_fraction={each.edge}",)),
        of_scene=True,
    ),
    _law(
        "mixture_of_jet",
        lambda scene: _has_given_mixture(scene) and _is_as_of_jets(scene.lubricant.mixture_fraction),
        _nominal_speed_factor,
        _NO_JET,
        of_scene=True,
    ),
    _law("jet_flow", lambda scene: scene.lubricant.mixture_fraction is None, lambda at: at.while_turning(at.speed_factor), *_FACTOR_OF_TWO),
    _law("grease_speed", _has_grease, lambda at: at.while_turning(at.speed_factor), high=_grease_speed_factor),
    _law(
        "grease_temperature",
        _has_grease,
        lambda at: at.samples["oil_temperature"],
        low=lambda scene: -math.inf if scene.lubricant.grease.lowest_temperature is None else scene.lubricant.grease.lowest_temperature,
        high=lambda scene: math.inf if scene.lubricant.grease.highest_temperature is None else scene.lubricant.grease.highest_temperature,
    ),
    _law("thin_film", _always, lambda at: at.while_running(at.samples["viscosity_ratio"])),
    _law(
        "starved_film",
        lambda scene: scene.lubricant.starvation.law != "none",
        lambda at: at.while_turning(at.replenishment),
        Variation("contacts with full inlets", overrides=("lubricant.starvation=none",)),
    ),
    _law("churning_reynolds", _has_mixture, lambda at: at.churning_reynolds, *_FACTOR_OF_TWO),
    _law("end_face_reynolds", _always, lambda at: at.end_face_reynolds, *_FACTOR_OF_TWO),
    _law("cage_gap", _always, _widest_gap, Variation("drag greater by its half", {"drag": 1.5}), of_scene=True),
    _law("land_length", _has_lands, lambda scene: scene.bearing.cage.guide_land_width / (2.0 * scene.bearing.cage.land_radius), of_scene=True),
    _law("land_clearance", _has_lands, lambda scene: scene.bearing.cage.guide_clearance / scene.bearing.cage.land_radius, of_scene=True),
    _law(
        "land_laminar",
        lambda scene: _has_lands(scene) and not scene.bearing.cage.land_vortices,
        lambda at: at.land_taylor,
        Variation("drag of lands with vortices", {"lands": lambda each, at: float(vortex_factor(each.value))}),
    ),
    _law(
        "land_heating",
        _has_lands,
        lambda at: at.land_nahme,
        Variation("drag of lands that heat themselves", {"lands": lambda each, at: float(heated_shear(each.value))}),
    ),
    _law(
        "pocket_film",
        lambda scene: scene.cage_whirls,
        lambda scene: scene.bearing.cage.pocket_clearance / scene.bearing.roller.diameter,
        of_scene=True,
    ),
    _law("hertz_pressure", _always, lambda at: 1e-9 * at.pressure),
    _law(
        "iso_spring_steel",
        lambda scene: scene.bearing.contact.spring == "iso",
        lambda scene: 1e-9 * scene.bearing.material.youngs_modulus,
        Variation("the spring of Palmgren", overrides=("bearing.contact.spring=palmgren",)),
        of_scene=True,
    ),
    _law("roller_slenderness", _always, lambda scene: scene.bearing.roller.length / scene.bearing.roller.diameter, of_scene=True),
    _law("diameter_ratio", _always, lambda scene: scene.bearing.diameter_ratio, of_scene=True),
    _law("life_load", _always, lambda at: at.while_turning(at.equivalent_load / rate(at.scene.bearing).dynamic)),
    _law(
        "catalogue_life",
        lambda scene: scene.life.method == "iso281",
        lambda at: at.while_turning(at.samples["reference_load"] / np.maximum(at.samples["equivalent_load"], _LOADED_FROM)),
        Variation("the life of ISO/TS 16281", overrides=("life.method=iso16281",)),
    ),
    _law("static_load", _always, lambda at: at.radial_load / rate(at.scene.bearing).static),
    _law(
        "viscosity_ratio",
        lambda scene: scene.life.a_iso != "none",
        lambda at: at.while_turning(at.samples["viscosity_ratio"]),
        Variation(
            "kappa at the end of its range",
            {"viscosity_ratio": lambda each, at: each.edge / each.value},
        ),
    ),
    _law(
        "life_laminae", _by_laminae, lambda scene: float(scene.life.laminae), Variation("40 laminae", overrides=("life.laminae=40",)), of_scene=True
    ),
    _law(
        "roller_profile",
        _by_laminae,
        lambda scene: float(isinstance(scene.bearing.roller.crown, NoCrown)),
        Variation("ISO's logarithmic profile", overrides=("bearing.roller.crown=iso_log",)),
        of_scene=True,
    ),
    _law("oil_temperature", _always, lambda at: at.samples["oil_temperature"], low=_lowest_oil, high=_highest_oil),
    _law(
        "local_temperature",
        lambda scene: scene.heat.law != "none",
        lambda at: np.fmax.reduce([at.samples[name] for name in _LOCAL]),
        high=_highest_oil,
    ),
    _law("polyamide_cage", _has_polyamide_cage, lambda at: part_temperature(at.samples, "roller_temperature")),
    _law(
        "ring_stabilisation",
        lambda scene: readable_designation(scene.bearing.designation) is not None,
        lambda at: np.fmax(part_temperature(at.samples, "inner_ring_temperature"), part_temperature(at.samples, "outer_ring_temperature")),
        high=_stabilised_to,
    ),
    _law(
        "mineral_oil",
        lambda scene: scene.lubricant.oil.base == "mineral" and scene.lubricant.grease is None,
        lambda at: part_temperature(at.samples, "oil_outlet_temperature"),
    ),
    _law(
        "shaft_in_air",
        lambda scene: scene.heat.law == "network" and scene.heat.conductances.shaft_ambient is None,
        lambda at: at.while_turning(np.abs(at.samples["shaft_speed"]) * at.scene.bearing.bore_diameter**2 / (2.0 * _AIR_VISCOSITY)),
    ),
    _law("oil_viscosity", lambda scene: isinstance(scene.lubricant.oil, CustomOil), lambda at: 1e6 * at.viscosity / at.density),
    _law("class_pressure_viscosity", _by_kind_of_oil, lambda at: 1e6 * at.film_viscosity / at.film_density),
    _law("viscosity_index", _by_viscosity_index, lambda scene: 1e6 * viscosity_100(scene.lubricant.oil), of_scene=True),
    _law("speed_factor", _always, lambda at: at.speed_factor),
    _law(
        "given_temperatures",
        lambda scene: scene.heat.law == "given" and scene.bearing.dimensions_at == "running",
        _parts_differ_from_oil,
        of_scene=True,
    ),
    _law(
        "inner_ring_stress",
        _is_cold,
        lambda at: 1e-6 * largest_hoop_stress(at.scene.bearing, at.params.mounted, at.samples["shaft_speed"]),
        high=lambda scene: 1e-6 * scene.bearing.material.strength,
    ),
    _law(
        "sleeve_seat",
        lambda scene: _is_cold(scene) and scene.mounting.shaft.sleeve is not None,
        lambda at: 1e-6 * sleeve_pressure(at.scene.bearing, at.scene.mounting, at.samples["shaft_speed"]) * np.ones(len(at.samples)),
    ),
    _law(
        "shaft_seat",
        lambda scene: _is_cold(scene) and mounted(scene.bearing, scene.mounting).shaft.pressure > 0.0,
        lambda at: 1e-6 * seat_pressure(at.params.mounted, at.samples),
    ),
    _law(
        "squeeze_film_eccentricity",
        _has_squeeze_film,
        lambda at: np.hypot(at.samples["outer_ring_y"], at.samples["outer_ring_z"]) / at.scene.support.outer_ring.squeeze_film.clearance,
    ),
    _law(
        "squeeze_film_length",
        _has_squeeze_film,
        lambda scene: scene.support.outer_ring.squeeze_film.length / (2.0 * scene.support.outer_ring.squeeze_film.radius),
        of_scene=True,
    ),
    _law(
        "squeeze_film_reynolds",
        _has_squeeze_film,
        lambda at: at.while_turning(
            at.density * np.abs(at.samples["shaft_speed"]) * at.scene.support.outer_ring.squeeze_film.clearance**2 / at.viscosity
        ),
    ),
    _law(
        "flange_axial_ratio",
        _has_axial_load,
        lambda at: at.while_turning(abs(at.scene.operating.axial_load) / np.maximum(at.radial_load, 1e-9)),
    ),
    _law("flange_axial_load", _has_axial_load, _flange_load_share),
    _law(
        "flange_gap",
        lambda scene: scene.bearing.flanges.present,
        lambda at: at.while_turning(_flange_speed(at) * flange_geometry(at.scene.bearing).end_clearance * at.density / at.viscosity),
    ),
    _law(
        "outer_ring_thickness",
        lambda scene: scene.outer_ring_bends,
        _thickness_of_waves,
        of_scene=True,
        high=lambda scene: _THICK_WITH_SHEAR if scene.bearing.outer_ring.shear else _THICK_WITHOUT,
    ),
    _law("seat_arc", _has_seat, lambda at: np.degrees(at.samples["seat_arc"])),
    _law("ring_loose", _has_seat, _seat_play, Variation("line to line", overrides=_LINE_TO_LINE)),
    _law(
        "limiting_speed",
        lambda scene: scene.bearing.ratings.limiting_speed is not None,
        lambda at: np.abs(at.samples["shaft_speed"]) * (30.0 / math.pi),
        high=lambda scene: scene.bearing.ratings.limiting_speed * 30.0 / math.pi,
    ),
    _law(
        "estimated_rollers",
        lambda scene: bool(scene.bearing.estimated),
        lambda scene: float(any(each.field in ("roller.count", "roller.diameter") for each in scene.bearing.estimated)),
        of_scene=True,
    ),
    _law(
        "full_complement_play",
        lambda scene: scene.bearing.cage.is_absent,
        lambda scene: math.pi / math.asin(scene.bearing.diameter_ratio) - scene.bearing.roller.count,
        of_scene=True,
    ),
)
"""All limits that are watched, by subject."""

UNWATCHED = tuple(_TABLE["unwatched"].items())
"""Laws with constants for which no range is known or none is needed, and why."""

MINIMUM_LOAD = _law(
    "minimum_load", lambda scene: scene.bearing.radial_clearance_at_low_points >= 0.0, lambda at: at.while_turning(_share_of_minimum_load(at))
)
"""Of no law but of the bearing's use, so that tables of many points judge it and runs do not: those tell it before they start."""

BY_NAME = {law.name: law for law in LAWS}
_PLACE = {name: place for place, name in enumerate(BY_NAME)}


def scene_exceedances(scene: Scene) -> list[Exceedance]:
    """Return the limits that a scene exceeds by itself, whatever its samples."""
    found = []
    for law in LAWS:
        if law.of_scene and law.applies(scene):
            value, (low, high) = law.value(scene), law.limits(scene)
            if value < low or value > high:
                found.append(law.exceeded(value, low, high))
    return found


def sample_laws(scene: Scene, laws: Iterable[Law] = ()) -> list[tuple[Law, float, float]]:
    """Return the laws of a scene whose quantity depends on the sample, each with its range, in the order of `LAWS`.

    Parameters
    ----------
    scene : of the samples.
    laws : that replace those of the same name, such as `bearing_sim.watchers.estimation.two_states.laws_of_table`.
    """
    known = BY_NAME | {law.name: law for law in laws}
    return [(law, *law.limits(scene)) for law in known.values() if not law.of_scene and law.applies(scene)]


def outside(scene: Scene, samples: np.ndarray, names: Sequence[str] = (), laws: Iterable[Law] = ()) -> list[Exceedance]:
    """Return the limits that a scene or any of its samples exceeds, each with its worst value, in the order of `LAWS`.

    Parameters
    ----------
    scene : of the samples.
    samples : shape (n,), n at least 1, see `bearing_sim.model.sample`.
    names : of the only laws to judge; all by default.
    laws : as in `sample_laws`.
    """
    at, found = Conditions(scene, samples), scene_exceedances(scene)
    for law, low, high in sample_laws(scene, laws):
        if not names or law.name in names:
            found += worst(law, low, high, law.value(at))
    return in_order(each for each in found if not names or each.law.name in names)


def below_minimum_load(scene: Scene, samples: np.ndarray) -> list[Exceedance]:
    """Return the makers' minimum load if any sample of a scene is below it, the least of them; see `MINIMUM_LOAD`."""
    law = MINIMUM_LOAD
    return worst(law, law.low, law.high, law.value(Conditions(scene, samples))) if law.applies(scene) else []


def in_order(exceedances: Iterable[Exceedance]) -> list[Exceedance]:
    """Return exceedances in the order of `LAWS`."""
    return sorted(exceedances, key=lambda each: _PLACE[each.law.name])


def cell(exceedances: Iterable[Exceedance]) -> str:
    """Return exceedances as one cell of a table, name and value of each; empty for none."""
    return _SEPARATOR.join(each.short for each in exceedances)


def merged(cells: Iterable[str]) -> str:
    """Return several cells (see `cell`) as one, with the first value of each law."""
    found = {each.partition(" ")[0]: each for text in reversed(list(cells)) for each in text.split(_SEPARATOR) if each}
    return _SEPARATOR.join(sorted(found.values()))


def counted(cells: Iterable[str], with_assumptions: bool = False) -> list[str]:
    """Return one sentence for each law in cells of a table (see `cell`): in how many it is outside of its range, its values, and what to do.

    Parameters
    ----------
    cells : of a table, whose effects are not computed.
    with_assumptions : whether ranges that are assumptions count, too.
    """
    values: dict[str, list[float]] = {}
    for each in (each for text in cells for each in text.split(_SEPARATOR) if each):
        name, *number = each.split(" ")[:2]
        values.setdefault(name, []).append(float(number[0]) if number else math.nan)
    known = BY_NAME | {MINIMUM_LOAD.name: MINIMUM_LOAD}
    reported = (name for name in values if with_assumptions or not known[name].is_assumed)
    return [f"{len(values[name])} x {known[name].counted_text(values[name])}" for name in reported]


def worst(law: Law, low: float, high: float, values: np.ndarray) -> list[Exceedance]:
    """Return the worst of the values outside a range, or nothing; NaN is inside."""
    extremes = [law.exceeded(float(pick(values)), low, high) for pick in (np.fmin.reduce, np.fmax.reduce)]
    beyond = [each for each in extremes if each.value < low or each.value > high]
    return [max(beyond, key=lambda each: each.excess)] if beyond else []


def still_sample(scene: Scene) -> np.ndarray:
    """Return a block of one sample at a scene's operating conditions, with ideal rolling and without roller loads, for laws and their checks."""
    operating, bearing, sample = scene.operating, scene.bearing, new_block(1, scene.bearing.roller.count)
    cage_speed = 0.5 * operating.shaft_speed * (1.0 - bearing.diameter_ratio)
    sample["shaft_speed"], sample["oil_temperature"] = operating.shaft_speed, scene.lubricant.temperature
    sample["load_y"] = operating.radial_load * math.cos(operating.load_angle)
    sample["load_z"] = operating.radial_load * math.sin(operating.load_angle)
    sample["cage_speed"] = sample["ideal_cage_speed"] = sample["orbital_speed"] = cage_speed
    sample["roller_radius"], sample["roller_spin"] = bearing.pitch_radius, math.nan
    sample["equivalent_load"] = operating.radial_load
    return sample
