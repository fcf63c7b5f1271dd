#!/usr/bin/env bash
# Proves that a clone and nothing else is enough: in a fresh Debian 12 the demo runs and the tests pass.
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1

usage() {
  cat <<'END'
usage: tests/system/fresh_debian.sh [--demo | --fast] [--keep]

Unpacks a minimal Debian 12, clones HEAD of this repository into it (what is not committed is not there), and runs
in a chroot ./tools/demo and ./tools/check. From outside come only Debian packages, through this machine's apt
sources. Needs root, mmdebstrap and unshare. The tree's tarball is kept in ${SLAMD_CACHE:-~/.cache/slamd}.

  --demo  only the demo
  --fast  ./tools/check --fast instead of ./tools/check
  --keep  leaves the tree there and says where
  --help  prints this

Prints lines that begin with PASS, FAIL or SKIP. Exit: 0 nothing failed, 1 something did, 2 unknown argument.
END
}

check=(./tools/check) keep=no
for argument in "$@"; do
  case "$argument" in
    --demo) check=() ;;
    --fast) check=(./tools/check --fast) ;;
    --keep) keep=yes ;;
    --help | -h) usage; exit 0 ;;
    *) echo "tests/system/fresh_debian.sh: unknown argument '$argument'" >&2; usage >&2; exit 2 ;;
  esac
done

status=0
pass() { echo "PASS fresh: $1"; }
fail() { echo "FAIL fresh: $1"; status=1; }
skip() { echo "SKIP fresh: $1"; exit 0; }

demo_limit_s=600
[ "$(id -u)" -eq 0 ] || skip "only root may chroot"
for tool in mmdebstrap unshare git; do
  command -v "$tool" >/dev/null || skip "$tool is not installed"
done
unshare --mount --pid --fork true 2>/dev/null || skip "this machine allows no mount namespace"

cache=${SLAMD_CACHE:-${HOME:-/root}/.cache/slamd}
logs=$PWD/build/check
mkdir -p "$cache" "$logs"

# make_tarball FILE: a minimal Debian 12 with this machine's apt sources, proxy and certificates.
make_tarball() {
  local file arguments=() sources=()
  for file in /etc/apt/apt.conf /etc/apt/apt.conf.d/*; do
    if [ -f "$file" ] && grep -q 'Acquire::' "$file"; then arguments+=(--aptopt="$file"); fi
  done
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources; do
    if [ -f "$file" ] && grep -q '^[^#]*bookworm' "$file" && grep -q debian "$file"; then sources+=("$file"); fi
  done
  # The image has what every clone needs beforehand: git.
  mmdebstrap --mode=root --variant=minbase --include=git,ca-certificates "${arguments[@]}" \
    --customize-hook='mkdir -p "$1/usr/local/share/ca-certificates"' \
    --customize-hook='cp -r /usr/local/share/ca-certificates/. "$1/usr/local/share/ca-certificates/" || true' \
    --customize-hook='chroot "$1" update-ca-certificates' \
    bookworm "$1" "${sources[@]}"
}

tarball=$cache/fresh-debian-12.tar
if [ ! -e "$tarball" ]; then
  if ! make_tarball "$tarball.new.tar" >"$logs/fresh_mmdebstrap.log" 2>&1; then
    rm -f "$tarball.new.tar"
    skip "no Debian 12: $(tail -n 1 "$logs/fresh_mmdebstrap.log") (see $logs/fresh_mmdebstrap.log)"
  fi
  mv "$tarball.new.tar" "$tarball"
fi

root=$(mktemp -d "$cache/fresh-debian.XXXXXX")
clean_up() {
  if [ "$keep" = yes ]; then echo "kept: $root"; else rm -rf --one-file-system "$root"; fi
}
trap clean_up EXIT
# Device nodes come from this machine's /dev.
tar --extract --file "$tarball" --directory "$root" --exclude './dev/*' || { fail "the tree unpacks"; exit 1; }
for file in /etc/resolv.conf /etc/hosts; do
  if [ -e "$file" ]; then cp --dereference "$file" "$root$file"; fi
done
if git clone --quiet --no-local . "$root/root/slamd" && [ "$(git -C "$root/root/slamd" rev-parse HEAD)" = "$(git rev-parse HEAD)" ]; then
  pass "cloned $(git rev-parse --short HEAD)"
else
  fail "git clone"
  exit 1
fi

# inside COMMAND...: runs it in the clone. Its mounts and its processes end with it, whatever happens.
inside() {
  unshare --mount --pid --fork --kill-child --propagation private bash -c '
    set -e
    root=$1
    shift
    # The root is a mount of its own, or "ip netns exec" could not change it.
    mount --bind "$root" "$root"
    mount -t proc proc "$root/proc"
    mount -t sysfs sysfs "$root/sys"
    mount --rbind /dev "$root/dev"
    exec chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
      http_proxy="${http_proxy:-}" https_proxy="${https_proxy:-}" \
      bash -c "cd /root/slamd && exec \"\$@\"" bash "$@"' bash "$root" "$@" </dev/null
}

if inside bash -c 'command -v g++ || command -v cmake' >/dev/null; then
  fail "the tree is fresh (it has a compiler already)"
else
  pass "the tree has neither compiler nor CMake"
fi

began=$SECONDS
if inside ./tools/demo >"$logs/fresh_demo.log" 2>&1; then
  took=$((SECONDS - began))
  pass "./tools/demo ends well"
  if [ "$took" -le $demo_limit_s ]; then
    pass "./tools/demo takes $took s"
  elif awk -v cores="$(nproc)" '{ exit !($2 > 1.5 * cores) }' /proc/loadavg; then
    echo "SKIP fresh: ./tools/demo takes $took s, more than $demo_limit_s, on a machine with other work (load $(cut -d' ' -f1-3 /proc/loadavg))"
  else
    fail "./tools/demo takes $took s, more than $demo_limit_s"
  fi
  if grep -q '</html>' "$root/root/slamd/build/demo/vlp16/map/report.html"; then pass "the demo leaves a report"; else fail "the demo leaves a report"; fi
  grep -E '^ +(psf|iekf): APE|^KITTI|^end drift' "$logs/fresh_demo.log"
else
  ended=$?
  tail -n 20 "$logs/fresh_demo.log"
  fail "./tools/demo ends with status $ended after $((SECONDS - began)) s (see $logs/fresh_demo.log)"
fi

if [ ${#check[@]} -gt 0 ]; then
  began=$SECONDS
  if inside "${check[@]}" >"$logs/fresh_check.log" 2>&1; then
    pass "${check[*]} takes $((SECONDS - began)) s: $(tail -n 1 "$logs/fresh_check.log")"
  else
    grep -E '^FAIL ' "$logs/fresh_check.log" | sed 's/^/  /'
    fail "${check[*]} after $((SECONDS - began)) s: $(tail -n 1 "$logs/fresh_check.log") (see $logs/fresh_check.log)"
  fi
fi
exit $status
