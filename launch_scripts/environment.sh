# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
# Shared by demo.sh and test.sh; to be sourced. Needs $here, the folder of the checkout.
#
# Creates .venv if absent and installs the package there, and again whenever its sources have changed; says before each stage how long it took
# here the last time, or about how long it will take.

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
    "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))' >/dev/null 2>&1
}

find_python() {
    local candidate
    for candidate in ${PYTHON:+"$PYTHON"} python3 python3.14 python3.13 python3.12 python3.11; do
        if usable "$candidate"; then
            printf '%s' "$candidate"
            return
        fi
    done
    complain "needs Python 3.11 to 3.14, for which there are wheels of ROS 2; python3 is $(python3 --version 2>&1 || true). Install one, or set PYTHON: PYTHON=/path/to/python3 $0"
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

# timed STAGE TIMES WHAT COMMAND...: run a command and keep how many seconds it took; without a last time, TIMES the seconds of creating .venv
timed() {
    local kept="$venv/.bearing_sim_seconds_$1" unit="$venv/.bearing_sim_seconds_venv" expected='' what="$3" began=$SECONDS
    if [ -f "$kept" ]; then
        expected=" ($(cat "$kept") s the last time here)"
    elif [ -f "$unit" ]; then
        expected=" (about $(($2 * $(cat "$unit"))) s)"
    fi
    shift 3
    printf '%s%s\n' "$what" "$expected" >&2
    "$@"
    printf '%s\n' $((SECONDS - began)) >"$kept"
}

pip_install() {
    # --no-compile: most of what is installed is never imported; make_byte_code compiles what is.
    "$venv/bin/python" -m pip install -qq --no-compile "$@" || {
        printf '%s: the installation failed; see the message above\n' "$(basename "$0")" >&2
        exit 1
    }
}

# What a start imports is compiled now, and not at each start where Python may not write.
make_byte_code() {
    env -u PYTHONDONTWRITEBYTECODE "$venv/bin/python" -P - <<'END'
import compileall
import importlib.util
from contextlib import suppress

compileall.compile_dir(importlib.util.find_spec("bearing_sim").submodule_search_locations[0], quiet=1, workers=0)
with suppress(ImportError):  # ROS 2 may be absent
    import bearing_sim.cli.run
    import bearing_sim.simulation
    import bearing_sim.ros.node
END
}

# is_installed STAMP: whether that was installed from the sources as they are now
is_installed() {
    [ "$(cat "$venv/.bearing_sim_sources$1" 2>/dev/null)" = "$wanted" ]
}

# install_package [EXTRA]: the package, with an extra such as test
install_package() {
    local extra="${1:-}" began=$SECONDS
    if ! usable "$venv/bin/python"; then
        make_venv
        printf '%s\n' $((SECONDS - began)) >"$venv/.bearing_sim_seconds_venv"
    fi
    wanted=$(sources)
    is_installed "${extra:+_$extra}" && return
    timed "package${extra:+_$extra}" "$([ -n "$extra" ] && echo 15 || echo 4)" \
        "installing bearing_sim${extra:+ with all that its extra $extra needs}" pip_install --upgrade "$here${extra:+[$extra]}"
    [ -z "$extra" ] || make_byte_code
    printf '%s\n' "$wanted" | tee "$venv/.bearing_sim_sources" >"$venv/.bearing_sim_sources${extra:+_$extra}"
}

# add_extra EXTRA TIMES WHAT: what an extra needs beside the installed package; TIMES as of timed
add_extra() {
    is_installed "_$1" && return
    timed "$1" "$2" "installing $3" pip_install "bearing_sim[$1]"
    make_byte_code
    printf '%s\n' "$wanted" >"$venv/.bearing_sim_sources_$1"
}
