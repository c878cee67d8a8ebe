# Another release of Debian in a folder of this machine, for scripts/test: sourced after lib.sh, not run. Needs root.

# debian_mirror: the archive that this machine's apt uses, or Debian's own.
debian_mirror() {
  local mirror
  # shellcheck disable=SC2016  # $(REPO_URI) is apt's
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Origin: Debian' 'Label: Debian' 2>/dev/null | head -n 1) || true
  echo "${SOFTARM_DEBIAN_MIRROR:-${mirror:-http://deb.debian.org/debian}}"
}

# debian_root CODENAME FOLDER: FOLDER holds that release afterwards, with what this machine's apt is told of the network.
debian_root() {
  local codename=$1 root=$2 log=$2.log
  [ "$(id -u)" = 0 ] || die "a root folder of Debian's $codename needs root (debootstrap, mount, chroot)"
  command -v debootstrap >/dev/null || die "no debootstrap here: apt-get install debootstrap"
  if [ ! -f "$root/etc/apt/apt.conf.d/90softarm" ]; then
    say "Making Debian's $codename in $root (a few minutes) ..."
    rm -rf "$root"
    mkdir -p "$(dirname "$root")"
    debootstrap --variant=minbase --include=ca-certificates "$codename" "$root.new" "$(debian_mirror)" >"$log" 2>&1 || {
      tail -n 5 "$log" >&2
      rm -rf "$root.new"
      die "debootstrap of $codename failed (whole log: $log)"
    }
    { apt-config dump | grep -E '^Acquire::(https?|Check|Retries)' || true; } >"$root.new/etc/apt/apt.conf.d/90softarm"
    echo force-unsafe-io >"$root.new/etc/dpkg/dpkg.cfg.d/softarm"  # as in Debian's own images: no waiting for the disk
    mv "$root.new" "$root"
  fi
  cp /etc/resolv.conf /etc/hosts "$root/etc/"
}

# in_debian_root FOLDER PATH... -- NAME=VALUE... COMMAND ARGUMENT...: runs a command with FOLDER as its root and nothing else
# of the environment. The paths stand there under their own names; what was mounted, and every process, goes with the command.
in_debian_root() {
  local root=$1 paths=()
  shift
  while [ "$1" != -- ]; do
    paths+=("$1")
    shift
  done
  shift
  # shellcheck disable=SC2016  # those are of the inner shell
  unshare --mount --propagation private --pid --fork --kill-child /bin/bash -euc '
    root=$1 paths=$2
    shift 2
    mount -t proc proc "$root/proc"
    mount --rbind /sys "$root/sys"
    mount --rbind /dev "$root/dev"
    while IFS= read -r path; do
      [ -n "$path" ] || continue
      mkdir -p "$root$path"
      mount --bind "$path" "$root$path"
    done <<<"$paths"
    exec chroot "$root" /usr/bin/env -i HOME=/root LANG=C.UTF-8 TERM="${TERM:-dumb}" \
      PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"
  ' bash "$root" "$(printf '%s\n' "${paths[@]}")" "$@"
}
