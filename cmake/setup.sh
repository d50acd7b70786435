# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# Installation, configuration and build for studies/run and tests/run. Source it with these variables set:
#   hilda_root   root of the source tree
#   hilda_steps  number of steps that the script announces
#   hilda_say    file descriptor of the progress messages: 1 (default), or 2 where standard output is the result

hilda_say=${hilda_say:-1}
hilda_step=0
hilda_log_dir=$hilda_root/build/log
mkdir -p -- "$hilda_log_dir"

hilda_jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}

# Packages of Debian 12 for the program hilda and its figures.
hilda_packages=(g++ cmake ninja-build git libeigen3-dev libsuitesparse-dev libgsl-dev libsundials-dev libcli11-dev libfmt-dev
    python3 python3-matplotlib)

# Packages for grains and for the modules: HDF5, MPI, URDF, MJCF, pages of hilda view.
hilda_module_packages=(libthrust-dev libcub-dev libhdf5-dev libopenmpi-dev openmpi-bin libtrilinos-zoltan-dev liburdfdom-dev
    libmujoco-dev libjs-three)

# Packages for the documentation site (docs/build).
hilda_site_packages=(python3-numpy python3-sphinx python3-myst-parser python3-breathe python3-sphinx-copybutton furo doxygen
    libjs-katex nodejs)

hilda_die() { # EXIT_CODE MESSAGE
    printf 'hilda: error: %s\n' "$2" >&2
    exit "$1"
}

# Print the beginning of the line of a step; hilda_end prints the rest.
hilda_begin() { # NAME
    hilda_step=$((hilda_step + 1))
    hilda_since=$SECONDS
    printf '[%d/%d] %s: ' "$hilda_step" "$hilda_steps" "$1" >&"$hilda_say"
}
hilda_end() { printf '%s\n' "$1" >&"$hilda_say"; }

# Run a command with its output in a log file. On failure print the end of the log. Returns the command's exit code.
hilda_logged() { # LOG COMMAND...
    local log=$hilda_log_dir/$1 code=0
    shift
    "$@" >"$log" 2>&1 || code=$?
    if ((code != 0)); then
        hilda_end "failed after $((SECONDS - hilda_since)) s"
        # A missing package is reported by our own line; for any other failure print the end of the log.
        if ! grep '^hilda: missing:' "$log" >&2; then
            tail -n 30 -- "$log" >&2
        fi
        printf 'hilda: error: the full log is %s\n' "$log" >&2
    fi
    return "$code"
}

# True on Debian 12 or newer and on its derivatives (Ubuntu) where apt-get and dpkg-query are installed.
hilda_is_debian() {
    local ID='' ID_LIKE='' VERSION_ID=''
    [[ -r /etc/os-release ]] || return 1
    # shellcheck disable=SC1091
    . /etc/os-release
    command -v apt-get >/dev/null && command -v dpkg-query >/dev/null || return 1
    case $ID in
        debian) ((${VERSION_ID:-99} >= 12)) ;; # testing and unstable have no version number
        *) [[ $ID == ubuntu || " $ID_LIKE " == *' debian '* || " $ID_LIKE " == *' ubuntu '* ]] ;;
    esac
}

# True on Debian 12, the only system on which the build is known to be free of warnings.
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
    # A broken entry in the user's list of package sources must not stop the installation.
    hilda_apt update || true
    hilda_apt install --yes --no-install-recommends "$@"
}

# Install the packages that are missing.
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
        hilda_end "not Debian 12: nothing is installed, CMake names what is missing"
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
    # Downloads from a mirror can fail temporarily: try once more.
    if ! hilda_install "${missing[@]}" >"$hilda_log_dir/packages.log" 2>&1; then
        sleep 5
        hilda_logged packages.log hilda_install "${missing[@]}" || hilda_die 7 "could not install: ${missing[*]}"
    fi
    hilda_end "done ($((SECONDS - hilda_since)) s)"
}

hilda_configure() { # PRESET [CMAKE_ARGUMENT...]
    local preset=$1 code=0
    hilda_begin "configure $preset"
    local cache=$hilda_root/build/$preset/CMakeCache.txt
    if [[ -e $cache ]] && ! grep -q '^CMAKE_GENERATOR:INTERNAL=Ninja$' "$cache"; then
        hilda_end failed
        hilda_die 1 "build/$preset was configured with $(sed -n 's/^CMAKE_GENERATOR:INTERNAL=//p' "$cache"), and the presets use Ninja; remove the folder: rm -r build/$preset"
    fi
    # env -C instead of cd: the program that runs next resolves its paths in the user's folder.
    hilda_logged "configure-$preset.log" env -C "$hilda_root" cmake --preset "$@" || code=$?
    if ((code != 0)); then
        if grep -q '^hilda: missing:' "$hilda_log_dir/configure-$preset.log" || ! hilda_is_debian; then exit 7; fi
        exit 1
    fi
    hilda_end "done ($((SECONDS - hilda_since)) s)"
}

# Copy the output of a build to a log file and print its progress: on a terminal one line with the percentage and the
# current target, otherwise a line for each 10 %.
hilda_show_progress() { # LOG
    local line percent target width shown=-1 next=10 since=$SECONDS terminal=false
    if [[ -t $hilda_say ]]; then terminal=true; fi
    width=$(tput cols 2>/dev/null || printf 80)
    while IFS= read -r line; do
        printf '%s\n' "$line" >>"$1"
        if [[ $line =~ ^\[([0-9]+)/([0-9]+)\]\ (.*)$ ]]; then # Ninja
            percent=$((100 * BASH_REMATCH[1] / BASH_REMATCH[2])) target=${BASH_REMATCH[3]##*/}
        elif [[ $line =~ ^\[\ *([0-9]+)%\]\ (.*)$ ]]; then # Make
            percent=${BASH_REMATCH[1]} target=${BASH_REMATCH[2]##*/}
        else
            continue
        fi
        if $terminal; then
            printf -v line '      %3d %%  %s' "$percent" "$target"
            printf '\r\033[K%s' "${line:0:width-1}" >&"$hilda_say"
        elif ((percent >= next && percent != shown)); then
            printf '      %3d %%  %d s  %s\n' "$percent" $((SECONDS - since)) "$target" >&"$hilda_say"
            shown=$percent next=$((percent - percent % 10 + 10))
        fi
    done
    if $terminal; then printf '\r\033[K' >&"$hilda_say"; fi
}

hilda_build() { # PRESET [TARGET...]
    local preset=$1 targets=() log=$hilda_log_dir/build-$1.log code=0
    if (($# > 1)); then targets=(--target "${@:2}"); fi
    hilda_begin "build $preset"
    hilda_end "log in $log"
    : >"$log"
    # NINJA_STATUS: the progress is read from this form.
    NINJA_STATUS='[%f/%t] ' cmake --build "$hilda_root/build/$preset" --parallel "$hilda_jobs" "${targets[@]}" 2>&1 |
        hilda_show_progress "$log" || code=${PIPESTATUS[0]}
    if ((code != 0)); then
        printf '      failed after %d s\n' $((SECONDS - hilda_since)) >&"$hilda_say"
        grep -E -A 12 'FAILED|error' "$log" | head -n 40 >&2 || tail -n 30 -- "$log" >&2
        printf 'hilda: error: the build failed; the full log is %s\n' "$log" >&2
        exit 1
    fi
    printf '      done (%d s)\n' $((SECONDS - hilda_since)) >&"$hilda_say"
}
