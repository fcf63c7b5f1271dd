#!/usr/bin/env bash
# Proves that a clone and nothing else is enough: in a fresh Debian 12 the demo runs and the tests pass.
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
. tests/system/debian.bash

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

tarball=$cache/fresh-debian-12.tar
if [ ! -e "$tarball" ]; then
  # The image has what every clone needs beforehand: git.
  if ! debian_tarball "$tarball.new.tar" git,ca-certificates >"$logs/fresh_mmdebstrap.log" 2>&1; then
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
debian_tree "$tarball" "$root" || { fail "the tree unpacks"; exit 1; }
if git clone --quiet --no-local . "$root/root/slamd" && [ "$(git -C "$root/root/slamd" rev-parse HEAD)" = "$(git rev-parse HEAD)" ]; then
  pass "cloned $(git rev-parse --short HEAD)"
else
  fail "git clone"
  exit 1
fi

inside() { in_debian "$root" /root/slamd "$@"; }

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
