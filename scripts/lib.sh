# What the scripts of this folder share: sourced, not run. Sets up Debian's packages, builds, enters the install space.
#
# SOFTARM_BUILD_DIR  where to build (default: build/ of the checkout). Nothing outside of it is written, except that
#                    missing Debian packages are installed.
set -euo pipefail

# Debian's ROS belongs to /usr/bin/python3: whatever python3 the user has first on PATH must not run it.
export PATH="/usr/sbin:/usr/bin:/sbin:/bin:$PATH"
unset PYTHONHOME

SOFTARM_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
SOFTARM_BUILD_DIR=$(realpath -m -- "${SOFTARM_BUILD_DIR:-$SOFTARM_ROOT/build}")

say() { printf '%s\n' "$*" >&2; }
die() {
  say "${0##*/}: $*"
  exit 1
}

# install_packages GROUP...: installs what is missing of these groups of packages.txt; under 0.2 s where nothing is.
install_packages() {
  local groups missing group names known
  groups=$(IFS='|'; echo "$*")
  names=$(sed -nE "s/^($groups) +//p" "$SOFTARM_ROOT/scripts/packages.txt" | tr ' ' '\n' | sort -u)
  if ! command -v dpkg-query >/dev/null; then
    say "This is not Debian 12: install the equivalents of scripts/packages.txt yourself. Going on with what is there."
    return 0
  fi
  # shellcheck disable=SC2086  # names are words
  known=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $names 2>/dev/null | sed -n 's/^installed //p' | sort -u) || true
  missing=$(comm -23 <(echo "$names") <(echo "$known") | tr '\n' ' ')
  [ -n "${missing// /}" ] || return 0

  if [ "$(. /etc/os-release && echo "${VERSION_CODENAME:-}")" != bookworm ]; then
    say "This is not Debian 12 (bookworm), so nothing is installed here. Not found: $missing"
    return 0
  fi
  local as_root=()
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || die "packages are missing, and this is neither root nor is there sudo; as root: apt-get install $missing"
    as_root=(sudo)
  fi
  mkdir -p "$SOFTARM_BUILD_DIR"
  local log=$SOFTARM_BUILD_DIR/apt.log
  say "Installing Debian packages: $missing"
  # shellcheck disable=SC2086
  {
    "${as_root[@]}" apt-get -o DPkg::Lock::Timeout=600 update &&
      "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 install -y \
        --no-install-recommends $missing
  } </dev/null >"$log" 2>&1 || {
    tail -n 15 "$log" >&2
    die "apt-get failed (whole log: $log)"
  }
}

# show_progress LOG: passes what ninja prints; says so once there is something to build, with one line of progress on a
# terminal.
show_progress() {
  local line told=no
  while IFS= read -r line; do
    printf '%s\n' "$line"
    case $line in
      *'Re-checking globbed directories'*) ;;
      \[*)
        [ $told = yes ] || say "Building (log: $1) ..."
        told=yes
        [ ! -t 2 ] || printf '\r\033[K%.*s' "$((${COLUMNS:-80} - 1))" "$line" >&2
        ;;
    esac
  done
  [ ! -t 2 ] || printf '\r\033[K' >&2
}

# build TARGET [CMAKE_ARGUMENT...]: configures where needed and builds; quiet, in well under a second where nothing
# changed. The log stays in the build folder; its end is shown on failure.
build() {
  local target=$1 log=$SOFTARM_BUILD_DIR/build.log started=$SECONDS argument
  shift
  mkdir -p "$SOFTARM_BUILD_DIR"
  exec 9>"$SOFTARM_BUILD_DIR/.lock"
  flock -n 9 || { say "Waiting for another build in $SOFTARM_BUILD_DIR ..."; flock 9; }

  local cache=$SOFTARM_BUILD_DIR/CMakeCache.txt configure=no
  if [ -f "$cache" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$SOFTARM_ROOT" "$cache"; then
    rm -rf "$cache" "$SOFTARM_BUILD_DIR/CMakeFiles"  # the checkout was moved or copied
  fi
  [ -f "$SOFTARM_BUILD_DIR/build.ninja" ] && [ -f "$cache" ] || configure=yes
  for argument in "-DCMAKE_INSTALL_PREFIX=$SOFTARM_BUILD_DIR/install" "$@"; do
    grep -qE "^${argument%%=*}(:[A-Z]+)?=${argument#*=}\$" <(sed 's/^/-D/' "$cache" 2>/dev/null) || configure=yes
  done
  : >"$log"
  if [ $configure = yes ]; then
    say "Configuring in $SOFTARM_BUILD_DIR ..."
    cmake -S "$SOFTARM_ROOT" -B "$SOFTARM_BUILD_DIR" -G Ninja -DCMAKE_BUILD_TYPE=Release \
      -DCMAKE_INSTALL_PREFIX="$SOFTARM_BUILD_DIR/install" \
      -DPYTHON_EXECUTABLE=/usr/bin/python3 -DPython3_EXECUTABLE=/usr/bin/python3 "$@" >>"$log" 2>&1 9>&- || {
      grep -A12 'CMake Error' "$log" | head -n 40 >&2 || tail -n 30 "$log" >&2
      die "cmake failed (whole log: $log)"
    }
  fi
  if ! ninja -C "$SOFTARM_BUILD_DIR" "$target" 2>&1 9>&- | show_progress "$log" >>"$log"; then
    grep -A25 '^FAILED' "$log" | head -n 60 >&2 || tail -n 40 "$log" >&2
    die "the build failed (whole log: $log)"
  fi
  # The install space, because rosrun looks for no program of a package in a folder build/ of the package's own source.
  cmake --install "$SOFTARM_BUILD_DIR" >>"$log" 2>&1 9>&- || {
    tail -n 15 "$log" >&2
    die "the installation into $SOFTARM_BUILD_DIR/install failed (whole log: $log)"
  }
  exec 9>&-
  [ $((SECONDS - started)) -lt 5 ] || say "Built in $((SECONDS - started)) s."
}

# enter_install_space: ROS_PACKAGE_PATH, PYTHONPATH and so on of this build; logs of ROS go to the build folder.
enter_install_space() {
  set +u  # catkin's setup files read variables that may be unset
  # shellcheck disable=SC1091
  source "$SOFTARM_BUILD_DIR/install/setup.bash"
  set -u
  export PATH="/usr/sbin:/usr/bin:/sbin:/bin:$PATH"
  export ROS_HOME="$SOFTARM_BUILD_DIR/ros_home"
  export ROS_LOG_DIR="$ROS_HOME/log"
  mkdir -p "$ROS_LOG_DIR"
}
