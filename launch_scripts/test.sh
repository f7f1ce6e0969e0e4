#!/usr/bin/env bash
# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
# Install the test dependencies in .venv and run the tests; arguments are passed to pytest.
#
#   launch_scripts/test.sh [pytest arguments]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
. "$here/launch_scripts/environment.sh"
install_package test

cd "$here"
if [ $# = 0 ]; then # all tests, on all cores
    "$venv/bin/python" -m bearing_sim.cli compile --fixed-step # the code of the checkout, which the tests import
    set -- -n auto --dist loadgroup
fi
exec "$venv/bin/python" -m pytest "$@"
