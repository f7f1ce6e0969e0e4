# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
# Shared by demo.sh and test.sh; to be sourced. Needs $here, the folder of the checkout.
#
# Creates .venv if absent and installs the package there, and again whenever its sources have changed.

venv="$here/.venv"

complain() {
    printf '%s: %s\n' "$(basename "$0")" "$*" >&2
    exit 2
}

# The virtual environment has its own ROS; it must not mix with one sourced in the shell.
unset PYTHONPATH PYTHONHOME AMENT_PREFIX_PATH RMW_IMPLEMENTATION ROS_LOCALHOST_ONLY
if [ -n "${_ROS_WHEELS_BOOTSTRAP_COMPLETE:-}" ] || [ -n "${ROS_DISTRO:-}" ]; then
    unset _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH ROS_DISTRO
fi
export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST # the loopback interface only

usable() {
    "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' >/dev/null 2>&1
}

find_python() {
    local candidate
    for candidate in ${PYTHON:+"$PYTHON"} python3 python3.13 python3.12 python3.11; do
        if usable "$candidate"; then
            printf '%s' "$candidate"
            return
        fi
    done
    complain "needs Python 3.11 to 3.13; python3 is $(python3 --version 2>&1 || true). Install one, or set PYTHON: PYTHON=/path/to/python3 $0"
}

make_venv() {
    local python
    python=$(find_python)
    "$python" -c 'import venv, ensurepip' 2>/dev/null ||
        complain "$python has no venv module; on Debian and Ubuntu: apt install python3-venv"
    printf 'creating %s with %s\n' "$venv" "$("$python" --version)" >&2
    rm -rf "$venv"
    "$python" -m venv "$venv" || complain "$python could not create $venv"
}

sources() {
    (cd "$here" && find bearing_sim launch_scripts resource setup.py setup.cfg package.xml -type f ! -name '*.pyc' -print0 |
        LC_ALL=C sort -z | xargs -0 cksum | cksum)
}

# install_package [EXTRA]: the package with an extra, such as test
install_package() {
    local extra="${1:-}" wanted stamp
    usable "$venv/bin/python" || make_venv
    wanted=$(sources)
    stamp="$venv/.bearing_sim_sources${extra:+_$extra}"
    if [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$wanted" ]; then
        return
    fi
    printf 'installing bearing_sim and its dependencies (a minute or two the first time)\n' >&2
    # --no-compile: Python compiles what is imported, a small part of what is installed, when it is.
    "$venv/bin/python" -m pip install -qq --no-compile --upgrade "$here${extra:+[$extra]}" || {
        printf '%s: the installation failed; see the message above\n' "$(basename "$0")" >&2
        exit 1
    }
    printf '%s\n' "$wanted" >"$stamp"
}
