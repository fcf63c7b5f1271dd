#!/usr/bin/env bash
# The service as it is shipped: unit, packages, manual, completion; and with SLAMD_SERVICE_BOOT=1 (./tools/check --full) the
# packages installed in a Debian 12 that is booted with systemd as PID 1, where everything happens to it that may happen.
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
. tests/system/verdicts.bash
. tests/system/debian.bash
logs=$PWD/build/check
mkdir -p "$logs"

# The unit. verify ends with 0 whatever it finds: any word is a failure.
unit() {
  sed "s|/usr/bin/slamd|$bin/slamd|" systemd/slamd.service >"$scratch/slamd.service"
  systemd-analyze verify --man=no "$scratch/slamd.service" >"$scratch/verify" 2>&1
  if [ $? -eq 0 ] && [ ! -s "$scratch/verify" ]; then pass "systemd finds nothing wrong with the unit"; else fail "systemd-analyze verify: $(head -n 3 "$scratch/verify")"; fi
  local score; score=$(systemd-analyze security --offline=true --no-pager systemd/slamd.service | sed -n 's/.*Overall exposure level.*: //p')
  if systemd-analyze security --offline=true --threshold=20 --no-pager systemd/slamd.service >/dev/null; then
    pass "systemd-analyze security: ${score%% *}, at most 2.0"
  else
    fail "systemd-analyze security: $score, more than 2.0"
  fi
}
if command -v systemd-analyze >/dev/null; then unit; else skip "systemd-analyze is not installed"; fi
check "the shipped configuration is good" "$bin/slamd" --config systemd/slamd.toml --validate
printf '[[lidar]]\nmodel = "vlp17"\n' >"$scratch/wrong.toml"
refuses "--validate refuses a wrong one in a line" 2 'wrong.toml:2: lidar.model = ' "$bin/slamd" --config "$scratch/wrong.toml" --validate

# The completion, without bash-completion: what it needs of it stands here.
completes() {
  local what=$1 expected=$2 got
  shift 2
  got=$(PATH=$bin:$PATH bash -c '
    _init_completion() { words=("${COMP_WORDS[@]}") cword=$COMP_CWORD cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}; }
    _filedir() { COMPREPLY=("a file"); }
    compopt() { :; }
    . systemd/slamd.bash
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    _slamd "$1"
    printf "%s " "${COMPREPLY[@]}"' bash "$@")
  if [ "$got" = "$expected " ]; then pass "bash completes $what"; else fail "bash completes $what: '$got', not '$expected'"; fi
}
completes "an option" "--print-config" slamd --pri
completes "a key" "realtime.priority=" slamd --set realtime.pr
completes "a file" "a file" slamd --config ''
completes "a command" "set-pose" slamd-ctl se set-p
completes "one of several values" "campus" slamd-simulate --world ca

# cmake --install, for others than Debian.
if DESTDIR=$scratch/staged cmake --install "$(dirname "$bin")" --prefix /usr/local >"$scratch/said" 2>&1 &&
  grep -q '^ExecStart=/usr/local/bin/slamd --config /etc/slamd/slamd.toml' "$scratch/staged/usr/local/lib/systemd/system/slamd.service" &&
  [ -x "$scratch/staged/usr/local/bin/slamd" ] && [ -e "$scratch/staged/etc/slamd/slamd.toml" ]; then
  pass "cmake --install puts everything below a prefix, and the unit knows it"
else
  fail "cmake --install: $(tail -n 3 "$scratch/said")"
fi

for program in dh lintian; do
  command -v $program >/dev/null || { skip "packages: $program is not installed (tools/setup)"; exit $status; }
done
began=$SECONDS
if ./tools/package >"$logs/package.log" 2>&1; then
  pass "packages are built, and lintian has nothing to say ($((SECONDS - began)) s)"
else
  tail -n 20 "$logs/package.log"
  fail "packages are built, and lintian has nothing to say (see $logs/package.log)"
  exit 1
fi
deb=$(ls build/package/slamd_*_"$(dpkg --print-architecture)".deb)
tools_deb=$(ls build/package/slamd-tools_*_"$(dpkg --print-architecture)".deb)
dpkg-deb --fsys-tarfile "$deb" | tar x -C "$scratch" ./usr/share/man ./usr/lib/sysusers.d
if command -v man >/dev/null; then
  said=$(for page in "$scratch"/usr/share/man/man*/*; do LC_ALL=C.UTF-8 MANROFFSEQ='' man --warnings -l -Tutf8 -Z "$page" 2>&1 >/dev/null; done)
  if [ -z "$said" ]; then pass "the manual is well formed"; else fail "the manual: $said"; fi
else
  skip "the manual: man is not installed"
fi

if [ -z "${SLAMD_SERVICE_BOOT:-}" ]; then
  skip "the booted service is tried in ./tools/check --full (SLAMD_SERVICE_BOOT=1)"
  exit $status
fi
[ "$(id -u)" -eq 0 ] || { skip "only root may boot a container"; exit $status; }
needs mmdebstrap unshare systemd-nspawn g++
cache=${SLAMD_CACHE:-${HOME:-/root}/.cache/slamd}
tarball=$cache/systemd-debian-12.tar
mkdir -p "$cache"
if [ ! -e "$tarball" ]; then
  if ! debian_tarball "$tarball.new.tar" systemd,systemd-sysv,udev,iproute2,procps,ca-certificates >"$logs/service_mmdebstrap.log" 2>&1; then
    rm -f "$tarball.new.tar"
    skip "no Debian 12: $(tail -n 1 "$logs/service_mmdebstrap.log")"
    exit $status
  fi
  mv "$tarball.new.tar" "$tarball"
fi
root=$(mktemp -d "$cache/service.XXXXXX")
trap 'rm -rf "$scratch"; rm -rf --one-file-system "$root"' EXIT
debian_tree "$tarball" "$root" || { fail "the tree unpacks"; exit 1; }
mkdir "$root/slamd-test"
g++ -std=c++20 -O1 -static -o "$root/slamd-test/stop_thread" tests/system/stop_thread.cpp || { fail "stop_thread.cpp compiles"; exit 1; }
cp "$deb" "$tools_deb" tests/system/service_guest.bash "$root/slamd-test/"
# The next version is this one by another name.
dpkg-deb -R "$deb" "$scratch/next"
sed -i 's/^Version: .*/Version: 0.1.0+next/' "$scratch/next/DEBIAN/control"
dpkg-deb --root-owner-group -b "$scratch/next" "$root/slamd-test/next.deb" >/dev/null

in_debian "$root" /slamd-test bash -c 'apt-get -q update && apt-get -q install -y --no-install-recommends ./slamd_*.deb ./slamd-tools_*.deb' >"$logs/service_apt.log" 2>&1
if [ -x "$root/usr/bin/slamd" ] && [ -L "$root/etc/systemd/system/multi-user.target.wants/slamd.service" ]; then
  pass "apt installs the packages in a fresh Debian 12, and the service is enabled"
else
  tail -n 5 "$logs/service_apt.log"
  fail "apt installs the packages in a fresh Debian 12 (see $logs/service_apt.log)"
  exit 1
fi
# A container may not raise limits (CAP_SYS_RESOURCE is the machine's): two capabilities stand in for LimitRTPRIO and
# LimitMEMLOCK. All else is the unit as shipped.
mkdir -p "$root/etc/systemd/system/slamd.service.d" "$root/etc/systemd/system/multi-user.target.wants"
cat >"$root/run-limits.conf" <<'END'
[Service]
AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK
CapabilityBoundingSet=CAP_SYS_NICE CAP_IPC_LOCK
END
mv "$root/run-limits.conf" "$root/etc/systemd/system/slamd.service.d/limits.conf"
cat >"$root/etc/systemd/system/all-that-happens.service" <<'END'
[Unit]
After=multi-user.target
[Service]
Type=oneshot
TimeoutStartSec=900
ExecStart=/bin/bash -c '/bin/bash /slamd-test/service_guest.bash >/slamd-test/said 2>&1; systemctl --no-block poweroff'
END
ln -s ../all-that-happens.service "$root/etc/systemd/system/multi-user.target.wants/"
for unit in systemd-timesyncd.service systemd-resolved.service getty.target console-getty.service apt-daily.timer apt-daily-upgrade.timer; do
  ln -sf /dev/null "$root/etc/systemd/system/$unit"
done
began=$SECONDS
SYSTEMD_NSPAWN_UNIFIED_HIERARCHY=1 timeout -k 10 900 systemd-nspawn -D "$root" --register=no --keep-unit --private-network --boot --console=pipe \
  --capability=all </dev/null >"$logs/service_console.log" 2>&1
cp "$root/slamd-test/said" "$logs/service_guest.log" 2>/dev/null
cat "$logs/service_guest.log"
grep -q '^FAIL' "$logs/service_guest.log" && status=1
if grep -q '^DONE' "$logs/service_guest.log"; then pass "booted, tried and ended in $((SECONDS - began)) s"; else fail "the booted system was cut short (see $logs/service_console.log)"; fi
exit $status
