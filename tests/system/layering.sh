#!/usr/bin/env bash
# Proves that the layers bite: what a folder may not include does not compile, and core/ has none of what only
# daemon/ and drivers/ may have. Needs a build tree (SLAMD_BUILD, default build/release).
set -uo pipefail
cd "$(dirname "$0")/../.."
build=${SLAMD_BUILD:-build/release}
status=0
pass() { echo "PASS layering: $1"; }
fail() { echo "FAIL layering: $1"; status=1; }

# finds_nothing WHAT PATTERN FOLDER...
finds_nothing() {
  local what=$1 pattern=$2 hits
  shift 2
  if hits=$(grep -rnE --include='*.cpp' --include='*.hpp' "$pattern" "$@"); then
    fail "$what"
    echo "$hits" | head -n 10
  else
    pass "$what"
  fi
}

finds_nothing "no include goes up by ../" '^#include "\.\./' core drivers daemon tools tests
finds_nothing "core/ has no threads, locks, files, streams" \
  '^#include <(thread|mutex|shared_mutex|condition_variable|future|semaphore|latch|barrier|stop_token|fstream|iostream|filesystem|ctime|sys/[a-z]+\.h|unistd\.h|pthread\.h|spdlog/.*)>' core
finds_nothing "core/ reads no clock and no environment" \
  '(steady_clock|system_clock|high_resolution_clock|clock_gettime|gettimeofday|getenv)' core
finds_nothing "core/ writes no log" '(spdlog::|std::c(out|err|log)\b|\bprintf\()' core

# A command that compiles a source of core/geometry (or six at a time), for other sources than that one.
object=$(ninja -C "$build" -t targets all 2>/dev/null | grep -m1 -oE '^core/geometry/CMakeFiles/slamd_core_geometry\.dir/[^:]+\.o')
command=$(ninja -C "$build" -t commands "${object:-none}" 2>/dev/null | tail -n 1)
if [ -z "$command" ]; then
  fail "no compile command for core/geometry in $build"
  exit 1
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# compile LINE: tells whether a source with that line would compile as part of core/geometry.
compile() {
  echo "$1" >"$scratch/probe.cpp"
  local probe=${command/ -o */} # the source comes after -o and -c
  probe=$(sed -E 's/ -M[DTF]+( [^ ]+\.(o|d))?//g' <<<"$probe")
  (cd "$build" && bash -c "$probe -fsyntax-only $scratch/probe.cpp") >"$scratch/log" 2>&1
}

if compile '#include "core/base/stamp.hpp"'; then
  pass "core/geometry may include core/base"
else
  fail "core/geometry may include core/base: $(head -n 3 "$scratch/log")"
fi
for header in core/scan/deskew.hpp core/odometry/odometry.hpp drivers/recording/packet.hpp; do
  if [ ! -f "$header" ]; then
    fail "$header is not there any more: choose another one"
  elif compile "#include \"$header\""; then
    fail "core/geometry must not include $header, and can"
  elif grep -q 'No such file or directory' "$scratch/log"; then
    pass "core/geometry cannot include $header"
  else
    fail "core/geometry cannot include $header, but for another reason: $(head -n 3 "$scratch/log")"
  fi
done
if compile '#include <pcap/pcap.h>'; then
  fail "core/geometry must not include <pcap/pcap.h>, and can"
elif grep -q 'needs pcap among the DEPS' "$scratch/log"; then
  pass "an undeclared third-party header says what to declare"
else
  fail "<pcap/pcap.h> fails for another reason: $(head -n 3 "$scratch/log")"
fi
exit $status
