# What the scripts of this folder share: sourced, not run. Sets up Debian's packages, builds, enters the install space.
#
# SOFTARM_BUILD_DIR  where to build (default: build/ of the checkout). Nothing outside of it is written, except that
#                    missing Debian packages are installed.
set -euo pipefail
shopt -s extglob

# Debian's ROS belongs to /usr/bin/python3: whatever python3 the user has first on PATH must not run it.
export PATH="/usr/sbin:/usr/bin:/sbin:/bin:$PATH"
unset PYTHONHOME
# Messages for C++ and Python: nobody here reads the other three languages.
export ROS_LANG_DISABLE=geneus:genlisp:gennodejs

SOFTARM_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
SOFTARM_BUILD_DIR=$(realpath -m -- "${SOFTARM_BUILD_DIR:-$SOFTARM_ROOT/build}")
SOFTARM_STAMPS=$SOFTARM_BUILD_DIR/stamps

# What of the checkout is compiled or installed by each target (test/build/script_inputs_check.py compares with the build).
PROGRAMS_INPUTS=(CMakeLists.txt package.xml cmake config include launch msg python rviz src srv third_party)
ALL_INPUTS=("${PROGRAMS_INPUTS[@]}" bench test)

say() { printf '%s\n' "$*" >&2; }
die() {
  say "${0##*/}: $*"
  exit 1
}

# install_packages GROUP...: installs what is missing of these groups of packages.txt. Does not ask again before Debian's
# list of packages, or ours, has changed.
install_packages() {
  local groups missing names known
  groups=$(IFS='|'; echo "$*")
  local stamp=$SOFTARM_STAMPS/packages_${groups//|/_}
  [ ! "$stamp" -nt "$SOFTARM_ROOT/scripts/packages.txt" ] || [ ! "$stamp" -nt /var/lib/dpkg/status ] || return 0
  mkdir -p "$SOFTARM_STAMPS"
  names=$(sed -nE "s/^($groups) +//p" "$SOFTARM_ROOT/scripts/packages.txt" | tr ' ' '\n' | sort -u)
  if ! command -v dpkg-query >/dev/null; then
    say "This is not Debian: install the equivalents of scripts/packages.txt yourself. Continuing with what is installed."
    : >"$stamp"
    return 0
  fi
  # shellcheck disable=SC2086  # names are words
  known=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $names 2>/dev/null | sed -n 's/^installed //p' | sort -u) || true
  missing=$(comm -23 <(echo "$names") <(echo "$known") | tr '\n' ' ')
  [ -n "${missing// /}" ] || { : >"$stamp"; return 0; }

  case $(. /etc/os-release && echo "${VERSION_CODENAME:-}") in
    bookworm | bullseye | trixie) ;;
    *)
      say "This is not Debian 11, 12 or 13, so no packages are installed. Not found: $missing"
      return 0
      ;;
  esac
  local as_root=()
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || die "packages are missing, but there are no root rights and there is no sudo; as root: apt-get install $missing"
    as_root=(sudo)
  fi
  local log=$SOFTARM_BUILD_DIR/apt.log
  "${as_root[@]}" apt-get -o DPkg::Lock::Timeout=600 update </dev/null >"$log" 2>&1 || apt_failed "$log"
  local absent
  # shellcheck disable=SC2086
  absent=$(comm -23 <(printf '%s\n' $missing) <(apt-cache pkgnames | sort -u) | xargs)
  if [ -n "$absent" ]; then
    say "Left out, because this release of Debian does not have them: $absent"
    # shellcheck disable=SC2086
    missing=$(comm -23 <(printf '%s\n' $missing) <(printf '%s\n' $absent) | xargs)
  fi
  [ -n "$missing" ] || { : >"$stamp"; return 0; }
  say "Installing Debian packages: $missing"
  # shellcheck disable=SC2086
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600 install -y \
    --no-install-recommends $missing </dev/null >>"$log" 2>&1 || apt_failed "$log"
  : >"$stamp"
}

apt_failed() {
  tail -n 15 "$1" >&2
  die "apt-get failed (whole log: $1)"
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

# A stamp of a target says that it was built and installed. It bears the time just before that build looked at its first
# file, and holds the state of the configuration and the names of what was made. So a target is up to date, and needs
# neither ninja nor the lock, where
#   - no file or folder that it is made from is younger (a folder is, where something in it came, went or was renamed), and
#     no package of Debian was installed or changed since (compilers, libraries, ROS);
#   - the configuration is what it was, and the arguments asked for are in it;
#   - all that was made is still there.
# That is what ninja compares, too. Whoever builds another target meanwhile finds everything of this one up to date as well
# and leaves it alone: had it to be made anew, then because of a file that is younger than the stamp.

# configured [CMAKE_ARGUMENT...]: whether CMake's cache is of this checkout and has these arguments.
configured() {
  local cache argument
  [ -f "$SOFTARM_BUILD_DIR/build.ninja" ] && [ -f "$SOFTARM_BUILD_DIR/CMakeCache.txt" ] || return 1
  cache=$(<"$SOFTARM_BUILD_DIR/CMakeCache.txt")
  # Installed since then: with it the Python module is built.
  [[ $cache != *'pybind11_DIR:PATH=pybind11_DIR-NOTFOUND'* ]] || [ ! -d /usr/include/pybind11 ] || return 1
  for argument in "CMAKE_HOME_DIRECTORY=$SOFTARM_ROOT" "CMAKE_INSTALL_PREFIX=$SOFTARM_BUILD_DIR/install" "${@#-D}"; do
    [[ $'\n'$cache$'\n' == *$'\n'"${argument%%=*}":+([A-Z])="${argument#*=}"$'\n'* ]] || return 1
  done
}

configuration_state() { (cd "$SOFTARM_BUILD_DIR" && stat -c '%n %s %y' CMakeCache.txt build.ninja); }

# up_to_date TARGET [CMAKE_ARGUMENT...]
up_to_date() {
  local target=$1 stamp=$SOFTARM_STAMPS/$1 inputs=("${PROGRAMS_INPUTS[@]}") state file
  shift
  [ "$target" != all ] || inputs=("${ALL_INPUTS[@]}")
  [ -f "$stamp" ] && configured "$@" || return 1
  [ ! /var/lib/dpkg/status -nt "$stamp" ] || return 1
  [ -z "$(cd "$SOFTARM_ROOT" && find "${inputs[@]}" -name __pycache__ -prune -o -newer "$stamp" -print -quit 2>&1)" ] || return 1
  mapfile -t state <"$stamp"
  [ "${state[0]}"$'\n'"${state[1]}" = "$(configuration_state)" ] || return 1
  for file in "${state[@]:2}"; do
    [ -e "$file" ] || return 1
  done
}

# write_stamp TARGET BEGUN: the stamp of a target whose build began at this time.
write_stamp() {
  local stamp=$SOFTARM_STAMPS/$1
  {
    configuration_state
    cat "$SOFTARM_BUILD_DIR/install_manifest.txt"
    echo
    find "$SOFTARM_BUILD_DIR"/{test,bench,devel/lib} -type f -perm -u+x 2>/dev/null || true
  } | sed '/^$/d' >"$stamp.new"
  touch -d "$2" "$stamp.new"
  mv "$stamp.new" "$stamp"
}

# build TARGET [CMAKE_ARGUMENT...]: TARGET is live (what it takes to watch an arm), programs, python or all. Configures where needed,
# builds and installs; silent, and without waiting for anybody, where the target is up to date. There is one ninja in a build
# folder at a time: who has something to build waits. The log stays in the build folder; its end is shown on failure.
build() {
  local target=$1 log=$SOFTARM_BUILD_DIR/build.log started=$SECONDS begun
  ! up_to_date "$@" || return 0
  mkdir -p "$SOFTARM_STAMPS"
  exec 9>"$SOFTARM_BUILD_DIR/.lock"
  if ! flock -n 9; then
    say "Waiting for another build in $SOFTARM_BUILD_DIR ..."
    flock 9
    ! up_to_date "$@" || { exec 9>&-; return 0; }
  fi
  shift
  begun=$(date -d '-2 seconds' '+%F %T.%N')  # an edit in the grain of a file system's clock counts as one after

  : >"$log"
  configured "$@" || configure "$log" "$@"
  if ! ninja -C "$SOFTARM_BUILD_DIR" "$target" 2>&1 9>&- | show_progress "$log" >>"$log"; then
    grep -A25 '^FAILED' "$log" | head -n 60 >&2 || tail -n 40 "$log" >&2
    die "the build failed (whole log: $log)"
  fi
  # The install space, because rosrun looks for no program of a package in a folder build/ of the package's own source.
  cmake --install "$SOFTARM_BUILD_DIR" >>"$log" 2>&1 9>&- || {
    tail -n 15 "$log" >&2
    die "the installation into $SOFTARM_BUILD_DIR/install failed (whole log: $log)"
  }
  write_stamp "$target" "$begun"
  exec 9>&-
  [ $((SECONDS - started)) -lt 5 ] || say "Built in $((SECONDS - started)) s."
}

# configure LOG [CMAKE_ARGUMENT...]
configure() {
  local log=$1 cache=$SOFTARM_BUILD_DIR/CMakeCache.txt
  shift
  if [ -f "$cache" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$SOFTARM_ROOT" "$cache"; then
    rm -rf "$cache" "$SOFTARM_BUILD_DIR/CMakeFiles"  # the checkout was moved or copied
  fi
  say "Configuring in $SOFTARM_BUILD_DIR ..."
  cmake -S "$SOFTARM_ROOT" -B "$SOFTARM_BUILD_DIR" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_INSTALL_PREFIX="$SOFTARM_BUILD_DIR/install" \
    -DPYTHON_EXECUTABLE=/usr/bin/python3 -DPython3_EXECUTABLE=/usr/bin/python3 "$@" >>"$log" 2>&1 9>&- || {
    grep -A12 'CMake Error' "$log" | head -n 40 >&2 || tail -n 30 "$log" >&2
    die "cmake failed (whole log: $log)"
  }
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
