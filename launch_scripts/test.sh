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
if [ $# = 0 ]; then
    "$venv/bin/bearing-sim" compile --every-method # on all cores, where the tests would do it on one
fi
exec "$venv/bin/python" -m pytest "$@"
