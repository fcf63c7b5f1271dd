# A Debian 12 beside this one, for what needs a fresh machine. Sourced; needs root, mmdebstrap, unshare.

# debian_tarball FILE PACKAGE,...: a minimal Debian 12 with these, and with this machine's apt sources, proxy and certificates.
debian_tarball() {
  local file arguments=() sources=()
  for file in /etc/apt/apt.conf /etc/apt/apt.conf.d/*; do
    if [ -f "$file" ] && grep -q 'Acquire::' "$file"; then arguments+=(--aptopt="$file"); fi
  done
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources; do
    if [ -f "$file" ] && grep -q '^[^#]*bookworm' "$file" && grep -q debian "$file"; then sources+=("$file"); fi
  done
  mmdebstrap --mode=root --variant=minbase --include="$2" "${arguments[@]}" \
    --customize-hook='mkdir -p "$1/usr/local/share/ca-certificates"' \
    --customize-hook='cp -r /usr/local/share/ca-certificates/. "$1/usr/local/share/ca-certificates/" || true' \
    --customize-hook='chroot "$1" update-ca-certificates' \
    bookworm "$1" "${sources[@]}"
}

# debian_tree TARBALL ROOT: unpacks it, so that it finds the names of the network. Device nodes come from this machine's /dev.
debian_tree() {
  local file
  tar --extract --file "$1" --directory "$2" --exclude './dev/*' || return 1
  for file in /etc/resolv.conf /etc/hosts; do
    if [ -e "$file" ]; then cp --dereference "$file" "$2$file"; fi
  done
}

# in_debian ROOT DIRECTORY COMMAND...: runs it there. Its mounts and its processes end with it, whatever happens.
in_debian() {
  unshare --mount --pid --fork --kill-child --propagation private bash -c '
    set -e
    root=$1
    directory=$2
    shift 2
    # The root is a mount of its own, or "ip netns exec" could not change it.
    mount --bind "$root" "$root"
    mount -t proc proc "$root/proc"
    mount -t sysfs sysfs "$root/sys"
    mount --rbind /dev "$root/dev"
    exec chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
      http_proxy="${http_proxy:-}" https_proxy="${https_proxy:-}" DEBIAN_FRONTEND=noninteractive \
      bash -c "cd $directory && exec \"\$@\"" bash "$@"' bash "$1" "$2" "${@:3}" </dev/null
}
