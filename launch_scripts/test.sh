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
"" | "--long") "$venv/bin/python" -m bearing_sim.cli compile ;; # the code of the checkout, which the tests import
*) exec "$venv/bin/python" -m pytest "$@" ;;
esac
on_all_cores=("$venv/bin/python" -m pytest -n auto --dist loadgroup -m)
if [ -z "$*" ]; then
    exec "${on_all_cores[@]}" "not long"
fi
failed=0
"${on_all_cores[@]}" "long and not alone" || failed=$?
"$venv/bin/python" -m pytest -m "long and alone" || failed=$?
exit "$failed"
