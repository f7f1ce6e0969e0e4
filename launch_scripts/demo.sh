#!/usr/bin/env bash
# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
# Run the ROS 2 node on the bundled synthetic mission, record it and show the results.
#
#   launch_scripts/demo.sh [--duration S] [--scene SCENE] [--set FIELD=VALUE] [--no-open] [--help]
#
# Needs only Python 3.11 to 3.14 with venv, and access to a package index. Creates .venv in the checkout if absent and installs
# the package there when its sources have changed. All traffic stays on the loopback interface.
# Exit code: 0 success, 1 failure, 2 unsupported environment or usage, 130 interrupted.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
. "$here/launch_scripts/environment.sh"
install_package
# The model is compiled while ROS 2 is installed, and the node runs while the view is.
ready="$venv/.bearing_sim_has_ros"
rm -f "$ready"
{ add_extra ros 3 "ROS 2" && touch "$ready" && add_extra full 6 "what view, tables and pictures need"; } &

export PYTHONSAFEPATH=1 # the installed package, whatever the current folder holds
export BEARING_SIM_DEMO_DOMAIN_ID="${ROS_DOMAIN_ID:-}"
exec "$venv/bin/python" -m bearing_sim.ros.demo --out "$here/runs" --installing "$!" "$ready" "$@"
