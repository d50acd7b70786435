# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# The set-up that studies/run and tests/run share. Sourced, with these set before:
#   hilda_root   the source tree
#   hilda_steps  how many steps will be announced
# and, to keep standard output for the program's own result, hilda_say=2.

hilda_say=${hilda_say:-1}
hilda_step=0
hilda_log_dir=$hilda_root/build/log
mkdir -p -- "$hilda_log_dir"

hilda_jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}

# Packages of Debian 12. The tests add theirs.
hilda_packages=(g++ cmake ninja-build git libeigen3-dev libsuitesparse-dev libgsl-dev libsundials-dev libcli11-dev
    nlohmann-json3-dev libfmt-dev libspdlog-dev libthrust-dev libcub-dev python3 python3-matplotlib libbenchmark-dev)

hilda_die() { # EXIT_CODE MESSAGE
    printf 'hilda: error: %s\n' "$2" >&2
    exit "$1"
}

# Begins the line of a step; hilda_end closes it.
hilda_begin() { # NAME
    hilda_step=$((hilda_step + 1))
    hilda_since=$SECONDS
    printf '[%d/%d] %s: ' "$hilda_step" "$hilda_steps" "$1" >&"$hilda_say"
}
hilda_end() { printf '%s\n' "$1" >&"$hilda_say"; }

# Runs a command with its output in a log. On failure shows the end of the log, and returns the command's exit code.
hilda_logged() { # LOG COMMAND...
    local log=$hilda_log_dir/$1 code=0
    shift
    "$@" >"$log" 2>&1 || code=$?
    if ((code != 0)); then
        hilda_end "failed after $((SECONDS - hilda_since)) s"
        # What is missing matters more than how CMake says it; otherwise the end of the log tells.
        if ! grep '^hilda: missing:' "$log" >&2; then
            tail -n 30 -- "$log" >&2
        fi
        printf 'hilda: error: the full log is %s\n' "$log" >&2
    fi
    return "$code"
}

# Debian 12 or newer, or one of its children (Ubuntu), with its package tools at hand.
hilda_is_debian() {
    local ID='' ID_LIKE='' VERSION_ID=''
    [[ -r /etc/os-release ]] || return 1
    # shellcheck disable=SC1091
    . /etc/os-release
    command -v apt-get >/dev/null && command -v dpkg-query >/dev/null || return 1
    case $ID in
        debian) ((${VERSION_ID:-99} >= 12)) ;; # testing and unstable have no number
        *) [[ $ID == ubuntu || " $ID_LIKE " == *' debian '* || " $ID_LIKE " == *' ubuntu '* ]] ;;
    esac
}

# Exactly the system on which warnings are known to be none.
hilda_is_debian_12() {
    local ID='' VERSION_ID=''
    # shellcheck disable=SC1091
    [[ -r /etc/os-release ]] && . /etc/os-release && [[ $ID == debian && $VERSION_ID == 12 ]]
}

hilda_apt() {
    local sudo=()
    ((EUID == 0)) || sudo=(sudo)
    "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=120 "$@"
}

hilda_install() { # PACKAGE...
    # One broken source in the user's list must not stop the rest.
    hilda_apt update || true
    hilda_apt install --yes --no-install-recommends "$@"
}

# The step that brings what is missing.
hilda_get_packages() {
    hilda_begin packages
    local missing=() p
    if ! hilda_is_debian; then
        for p in cmake c++; do
            command -v "$p" >/dev/null || missing+=("$p")
        done
        if ((${#missing[@]})); then
            hilda_end "not Debian 12, and not found: ${missing[*]}"
            hilda_die 7 "please install: ${missing[*]}"
        fi
        hilda_end "not Debian 12: nothing installed, CMake will name what is missing"
        return
    fi

    for p in "${hilda_packages[@]}"; do
        [[ $(dpkg-query -W -f='${db:Status-Status}' "$p" 2>/dev/null) == installed ]] || missing+=("$p")
    done
    if ((${#missing[@]} == 0)); then
        hilda_end 'all present'
        return
    fi
    if ((EUID != 0)) && ! command -v sudo >/dev/null; then
        hilda_end "missing: ${missing[*]}"
        hilda_die 7 "not root and no sudo; please install: ${missing[*]}"
    fi
    printf 'installing %s ... ' "${missing[*]}" >&"$hilda_say"
    # Mirrors fail now and then: one more try.
    if ! hilda_install "${missing[@]}" >"$hilda_log_dir/packages.log" 2>&1; then
        sleep 5
        hilda_logged packages.log hilda_install "${missing[@]}" || hilda_die 7 "could not install: ${missing[*]}"
    fi
    hilda_end "done ($((SECONDS - hilda_since)) s)"
}

hilda_configure() { # PRESET [CMAKE_ARGUMENT...]
    local preset=$1 code=0
    hilda_begin "configure $preset"
    # A build folder keeps the generator it was born with.
    if command -v ninja >/dev/null && [[ ! -e $hilda_root/build/$preset/CMakeCache.txt ]]; then
        export CMAKE_GENERATOR=Ninja
    else
        unset CMAKE_GENERATOR
    fi
    # Not by cd: the program that runs next takes its paths from where the user is.
    hilda_logged "configure-$preset.log" env -C "$hilda_root" cmake --preset "$@" || code=$?
    if ((code != 0)); then
        if grep -q '^hilda: missing:' "$hilda_log_dir/configure-$preset.log" || ! hilda_is_debian; then exit 7; fi
        exit 1
    fi
    hilda_end "done ($((SECONDS - hilda_since)) s)"
}

hilda_build() { # PRESET [TARGET...]
    local preset=$1 targets=()
    if (($# > 1)); then targets=(--target "${@:2}"); fi
    hilda_begin "build $preset"
    hilda_logged "build-$preset.log" \
        cmake --build "$hilda_root/build/$preset" --parallel "$hilda_jobs" "${targets[@]}" || exit 1
    hilda_end "done ($((SECONDS - hilda_since)) s)"
}
