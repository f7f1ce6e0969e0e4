# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Write ``bearing_sim/model/names.pyi``, from which type checkers know the names of observables and results: python test/generate_names.py."""

from pathlib import Path

import numpy as np

from bearing_sim.model.sample import OBSERVABLES
from bearing_sim.sweep.point import RESULTS
from bearing_sim.sweep.settling import Outcome

STUB = Path(__file__).resolve().parents[1] / "bearing_sim/model/names.pyi"


def stub() -> str:
    """Return the text of the stub."""
    kinds = {name: kind.__name__ if kind is not np.ndarray else "np.ndarray" for name, kind in Outcome.__annotations__.items()}
    kinds |= {each.name: "float" for each in RESULTS} | {each.name: "NDArray[np.float64]" if each.per_roller else "float" for each in OBSERVABLES}
    return "\n".join(
        [
            "# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0",
            "# Written by test/generate_names.py from the observables of a sample and the results of a sweep.",
            "from typing import Literal",
            "",
            "import numpy as np",
            "from numpy.typing import NDArray",
            "",
            "from bearing_sim.simulation import Counters",
            "",
            "ObservableName = Literal[",
            *(f'    "{each.name}",' for each in OBSERVABLES),
            "]",
            "",
            "class SettledResults:",
            *(f"    @property\n    def {name}(self) -> {kind}: ..." for name, kind in kinds.items()),
            "",
        ]
    )


if __name__ == "__main__":
    STUB.write_text(stub())
