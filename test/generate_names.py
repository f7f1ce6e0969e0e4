# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Write ``bearing_sim/model/names.pyi``, from which type checkers know the names of observables and results, and what samples hold by name."""

from collections.abc import Sequence
from pathlib import Path

from bearing_sim.model.sample import OBSERVABLES
from bearing_sim.sweep.point import RESULTS
from bearing_sim.sweep.settling import DRIFTING, LIMIT_CYCLE, NO_STEADY_STATE, SETTLED, TOO_SHORT, WANDERING, Outcome

STUB = Path(__file__).resolve().parents[1] / "bearing_sim/model/names.pyi"
VERDICTS = (SETTLED, DRIFTING, LIMIT_CYCLE, WANDERING, TOO_SHORT, NO_STEADY_STATE)
# At run time both are what NumPy makes of records; the classes are for type checkers alone.
SAMPLES = """
class Sample(np.void):  # type: ignore[misc]
    @overload  # type: ignore[override]
    def __getitem__(self, key: BearingObservable) -> np.float64: ...
    @overload
    def __getitem__(self, key: RollerObservable) -> NDArray[np.float64]: ...
    @overload
    def __getitem__(self, key: str) -> Any: ...

class Block(np.ndarray[tuple[int], np.dtype[np.void]]):
    @overload  # type: ignore[override]
    def __getitem__(self, key: str) -> NDArray[np.float64]: ...
    @overload
    def __getitem__(self, key: int | np.integer) -> Sample: ...
    @overload
    def __getitem__(self, key: slice | NDArray[np.bool_] | NDArray[np.intp]) -> Block: ...
    @overload
    def __getitem__(self, key: list[str]) -> np.ndarray: ...
    def __iter__(self) -> Iterator[Sample]: ...
"""


def stub() -> str:
    """Return the text of the stub."""
    kinds = {name: kind.__name__ for name, kind in Outcome.__annotations__.items()} | {"verdict": "Verdict", "window": "Block"}
    kinds |= {each.name: "float" for each in RESULTS} | {each.name: "NDArray[np.float64]" if each.per_roller else "float" for each in OBSERVABLES}
    return "\n".join(
        [
            "# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0",
            "# Written by test/generate_names.py from the observables of a sample and the results of a sweep.",
            "from collections.abc import Iterator",
            "from typing import Any, Literal, overload",
            "",
            "import numpy as np",
            "from numpy.typing import NDArray",
            "",
            "from bearing_sim.simulation import Counters",
            "",
            *_literal("BearingObservable", [each.name for each in OBSERVABLES if not each.per_roller]),
            *_literal("RollerObservable", [each.name for each in OBSERVABLES if each.per_roller]),
            "ObservableName = BearingObservable | RollerObservable",
            *_literal("Verdict", VERDICTS),
            SAMPLES.rstrip(),
            "",
            "class SettledResults:",
            *(f"    @property\n    def {name}(self) -> {kind}: ..." for name, kind in kinds.items()),
            "",
        ]
    )


def _literal(name: str, words: Sequence[str]) -> list[str]:
    return [f"{name} = Literal[", *(f'    "{word}",' for word in words), "]"]


if __name__ == "__main__":
    STUB.write_text(stub())
