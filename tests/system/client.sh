#!/usr/bin/env bash
# The client library as a planner has it: installed by itself, found by CMake and by pkg-config, built against, run.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs cmake g++ pkg-config
prefix=$scratch/prefix

if cmake --install build/release --prefix "$prefix" --component client >"$scratch/install.log" 2>&1; then
  pass "the component client is installed by itself"
else
  fail "the component client is installed by itself: $(tail -n 3 "$scratch/install.log")"
fi
if [ -e "$prefix/bin" ] || [ -e "$prefix/etc" ]; then fail "it brings programs or configuration with it"; else pass "it brings nothing else with it"; fi

mkdir -p "$scratch/planner"
cp tests/client/map_watch.cpp "$scratch/planner/"
cat >"$scratch/planner/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(planner LANGUAGES CXX)
find_package(slamd-client REQUIRED)
add_executable(planner map_watch.cpp)
target_link_libraries(planner PRIVATE slamd::client)
END
if cmake -S "$scratch/planner" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$prefix" >"$scratch/cmake.log" 2>&1 &&
  cmake --build "$scratch/build" >>"$scratch/cmake.log" 2>&1; then
  pass "a program finds it by CMake and is built"
else
  fail "a program finds it by CMake and is built: $(grep -m 3 -iE 'error|not found' "$scratch/cmake.log")"
fi
"$scratch/build/planner" >/dev/null 2>&1
if [ $? -eq 2 ]; then pass "the program runs"; else fail "the program runs"; fi

pc=$(find "$prefix" -name slamd-client.pc)
flags=$(PKG_CONFIG_PATH=$(dirname "$pc") pkg-config --cflags --libs slamd-client)
# shellcheck disable=SC2086
if echo '#include "client/map_client.hpp"
int main(int n, char**) { if (n > 9) slamd::client::MapClient(); }' | g++ -std=c++20 -x c++ - $flags -o "$scratch/other" 2>"$scratch/other.log" && "$scratch/other"; then
  pass "another finds it by pkg-config, and runs"
else
  fail "another finds it by pkg-config: $(grep -m 2 error "$scratch/other.log")"
fi
exit "$status"
