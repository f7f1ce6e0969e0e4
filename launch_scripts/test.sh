#!/usr/bin/env bash
# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
# Install the test dependencies in .venv and run the tests.
#
#   launch_scripts/test.sh                     all but the long ones
#   launch_scripts/test.sh --long              the long ones: whole documents, killed programs, nodes over DDS
#   launch_scripts/test.sh pytest-arguments    what pytest makes of them
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
. "$here/launch_scripts/environment.sh"
install_package test

cd "$here"
case "$*" in
"") chosen="not long" ;;
"--long") chosen="long" ;;
*) chosen="" ;;
esac
if [ -n "$chosen" ]; then # on all cores
    "$venv/bin/python" -m bearing_sim.cli compile # the code of the checkout, which the tests import
    set -- -m "$chosen" -n auto --dist loadgroup
fi
exec "$venv/bin/python" -m pytest "$@"
