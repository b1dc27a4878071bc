# Provides the Debian 13 environment that PL-LIT builds and runs in. Sourced by ./demo, ./test and ./pllit.
#
#   in_environment COMMAND ARG...   replaces the shell: the command runs with Debian 13's packages, in the same working
#                                   directory, with the same arguments, streams and exit code
#
# On Debian 13 the packages are installed with apt and the command runs as it is. On any other Linux a Debian 13 root is
# made once with debootstrap; the command runs inside it, in a mount namespace of its own, so nothing stays mounted.

project_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
environment_root=${PLLIT_ENV:-${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/pllit/debian13}
package_lists=("$project_root/packages.txt")
[ "${PLLIT_TEST:-}" = 1 ] && package_lists+=("$project_root/packages-test.txt")
[ "${PLLIT_TRAIN:-}" = 1 ] && package_lists+=("$project_root/packages-train.txt")
# Directories of the machine that stay hidden inside the root, because Debian 13 brings its own.
own_directories='usr|bin|sbin|lib.*|etc|var|boot|proc|dev|sys|lost\+found'

say() { printf 'pllit: %s\n' "$*" >&2; }
refuse() { say "$*"; exit 1; }

wanted_packages() { sed -e 's/#.*//' -e '/^[[:space:]]*$/d' "${package_lists[@]}"; }
packages_digest() { wanted_packages | sort -u | sha256sum | cut -c1-16; }

is_debian_13() { [ -r /etc/os-release ] && (. /etc/os-release && [ "${ID:-}-${VERSION_ID:-}" = debian-13 ]); }

need_root() {
  [ "$(id -u)" = 0 ] || refuse "$1 needs root. Run it as root once, or use the container: docker build -t pllit '$project_root'" \
    "&& docker run --rm -it pllit ./demo (see Dockerfile)."
}

install_packages() { # runs on Debian 13 itself or inside the root; finishes what an interrupted run left
  export DEBIAN_FRONTEND=noninteractive
  dpkg --configure -a >&2
  apt-get update -q >&2
  # shellcheck disable=SC2046  # one word a package is wanted
  apt-get install -q -y --no-install-recommends --fix-broken $(wanted_packages) >&2
}

# --- Debian 13 itself ---------------------------------------------------------------------------------------------
ensure_native() {
  local stamp missing
  stamp=${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/pllit/native-$(packages_digest)
  [ -e "$stamp" ] && return
  missing=$(wanted_packages | while read -r name; do
    dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null | grep -qx installed || printf '%s ' "$name"
  done)
  if [ -n "$missing" ]; then
    [ "$(id -u)" = 0 ] || refuse "these packages are missing: $missing- install them with: sudo apt-get install $missing"
    say "installing packages: $missing"
    install_packages || refuse "apt could not install the packages of packages.txt; its message is above."
  fi
  mkdir -p "$(dirname "$stamp")" && : >"$stamp"
}

# --- any other Linux: a Debian 13 root ----------------------------------------------------------------------------
machine_mirror() { # the machine's own Debian mirror, or nothing: then debootstrap's default serves
  [ -n "${PLLIT_MIRROR:-}" ] && { printf '%s' "$PLLIT_MIRROR"; return; }
  (. /etc/os-release 2>/dev/null && [ "${ID:-}" = debian ]) || return 0
  cat /etc/apt/sources.list /etc/apt/sources.list.d/*.sources /etc/apt/sources.list.d/*.list 2>/dev/null |
    grep -oE '^(deb |URIs:).*' | grep -oE '[a-z+]+://[^ ]+' | grep -E '/debian/?$' | head -n 1
}

get_debootstrap() {
  command -v debootstrap >/dev/null && return
  command -v apt-get >/dev/null || refuse "debootstrap is missing: install it with this machine's package manager, then try again."
  say "installing debootstrap"
  { apt-get update -q && DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends debootstrap; } >&2 ||
    refuse "debootstrap could not be installed; apt's message is above."
}

copy_machine_settings() { # proxy, certificates and apt credentials, so that the root reaches what the machine reaches
  local root=$1
  if command -v apt-config >/dev/null; then
    apt-config dump | grep -E '^Acquire::([a-z]+::Proxy|https?|Check|Retries)' | grep -v '""' >"$root/etc/apt/apt.conf.d/90machine" || true
  fi
  [ -d /etc/apt/auth.conf.d ] && cp -r /etc/apt/auth.conf.d "$root/etc/apt/"
  mkdir -p "$root/etc/ssl/certs"
  [ -r /etc/ssl/certs/ca-certificates.crt ] && cp -L /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
  printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d" && chmod +x "$root/usr/sbin/policy-rc.d"
  printf 'force-unsafe-io\npath-exclude=/usr/share/doc/*\npath-exclude=/usr/share/man/*\npath-exclude=/usr/share/locale/*\n' \
    >"$root/etc/dpkg/dpkg.cfg.d/pllit"
}

make_root() {
  get_debootstrap
  local partial=$environment_root.partial
  rm -rf "$partial" "$environment_root"
  mkdir -p "$partial"
  say "making a Debian 13 root in $environment_root (a few minutes, once)"
  # A namespace of its own, so that an interrupted debootstrap leaves nothing mounted; and at /mnt, for it stumbles over spaces.
  # shellcheck disable=SC2046,SC2016  # an absent mirror must vanish
  unshare -m bash -c 'mount --bind "$1" /mnt && debootstrap --variant=minbase trixie /mnt "${@:2}"' - "$partial" $(machine_mirror) >&2 ||
    refuse "debootstrap failed; its message is above and its log is $partial/debootstrap/debootstrap.log."
  copy_machine_settings "$partial"
  mv "$partial" "$environment_root"
}

ensure_root() {
  local stamp
  stamp=$environment_root/.pllit-packages-$(packages_digest) # one for each list, so that calls that want more or less alternate freely
  [ -e "$stamp" ] && return
  need_root "Making the Debian 13 environment on this machine"
  mkdir -p "$(dirname "$environment_root")"
  exec {lock}>"$environment_root.lock"
  flock "$lock" # a second call waits for the first and then finds the work done
  [ -e "$stamp" ] && return
  [ -x "$environment_root/usr/bin/apt-get" ] || make_root
  say "installing the packages of packages.txt"
  (enter_root bash -c ". '$project_root/setup/environment.sh' && install_packages") ||
    refuse "apt could not install the packages inside $environment_root; its message is above. The next call tries again."
  : >"$stamp"
  exec {lock}>&-
}

mount_machine() { # inside a private mount namespace: every directory of the machine that the root does not bring itself
  local root=$1 name ancestor
  ancestor=/$(cut -d/ -f2 <<<"$root")
  for path in "$ancestor" /*; do # the directory that holds the root first, or later mounts would be mounted twice
    name=${path#/}
    [[ $name =~ ^($own_directories)$ ]] && continue
    if [ -L "$path" ]; then
      [ -e "$root/$name" ] || ln -s "$(readlink "$path")" "$root/$name"
    elif [ -d "$path" ] && ! mountpoint -q "$root/$name"; then
      mkdir -p "$root/$name" && mount --rbind "$path" "$root/$name" # with what is mounted below it, a data disk say
    fi
  done
  for name in proc dev sys; do mount --rbind "/$name" "$root/$name"; done
  for name in resolv.conf hosts; do
    [ -r "/etc/$name" ] || continue
    [ -e "$root/etc/$name" ] || : >"$root/etc/$name"
    mount --bind "$(readlink -f "/etc/$name")" "$root/etc/$name"
  done
}

enter_root() {
  need_root "Entering the Debian 13 environment"
  [[ $PWD =~ ^/($own_directories)(/|$) ]] && refuse "'$PWD' is hidden inside the Debian 13 environment; start from another folder."
  exec unshare --mount --propagation private bash -c '
    . "$1/setup/environment.sh" && mount_machine "$2" || exit 1
    root=$2 directory=$3; shift 3
    unset LD_LIBRARY_PATH LD_PRELOAD LIBRARY_PATH CPATH C_INCLUDE_PATH CPLUS_INCLUDE_PATH PKG_CONFIG_PATH CMAKE_PREFIX_PATH \
          CC CXX CFLAGS CXXFLAGS LDFLAGS PYTHONPATH PYTHONHOME VIRTUAL_ENV BASH_ENV ENV
    exec chroot "$root" /usr/bin/env --chdir="$directory" PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@"
  ' pllit "$project_root" "$environment_root" "$PWD" "$@"
}

in_environment() {
  if is_debian_13; then
    ensure_native
    exec "$@"
  fi
  ensure_root
  enter_root "$@"
}
