#!/usr/bin/env bash
# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
# Set up what the tests need in .venv and run them all; arguments go to pytest.
#
#   launch_scripts/test.sh [pytest arguments]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
. "$here/launch_scripts/environment.sh"
install_package test

cd "$here"
if [ $# = 0 ]; then # all of them: on all cores
    "$venv/bin/python" -m bearing_sim.cli compile --every-method # of the checkout, which the tests import
    set -- -n auto --dist loadgroup
fi
exec "$venv/bin/python" -m pytest "$@"
