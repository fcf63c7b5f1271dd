#!/usr/bin/env bash
# Broken configurations through slamd-replay: each is refused with exit code 2 and one line that names file, line, key,
# value and what is allowed. What --print-config prints reads back as the same configuration.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash

recording=$scratch/recording
mkdir "$recording"
touch "$recording/lidar.pcap"
printf '[[lidar]]\nmodel = "vlp16"\n' >"$recording/recording.toml"

# broken WHAT PATTERN TEXT: a --config file of that text (with \n) on top of a good recording.
broken() {
  printf '%b' "$3" >"$scratch/mine.toml"
  refuses "$1" 2 "^slamd-replay: $2" "$bin/slamd-replay" --out "$scratch/out_dir" --config "$scratch/mine.toml" "$recording"
}

file="$scratch/mine\.toml"
broken "an unknown key, with what was meant" \
  "$file:2: odometry\.fliter = 'psf': unknown key; did you mean odometry\.filter\?$" '[odometry]\nfliter = "psf"\n'
broken "an unknown table" "$file:1: camera = \{\}: unknown key; " '[camera]\n'
broken "a value of the wrong type" "$file:2: lidar\.max_range_m = 'far': must be a number from 1 to 1000$" \
  '[[lidar]]\nmax_range_m = "far"\n'
broken "a value out of range" "$file:3: lidar\.port = 70000: must be a whole number from 0 to 65535$" \
  '\n[[lidar]]\nport = 70000\n'
broken "a value in another unit" "$file:2: lidar\.scan_period_ms = 0\.1: must be a number from 20 to 500$" \
  '[[lidar]]\nscan_period_ms = 0.1\n'
broken "a word that is no choice" "$file:2: odometry\.filter = 'kalman': must be one of \"psf\", \"iekf\"$" \
  '[odometry]\nfilter = "kalman"\n'
broken "a model that is not read" "$file:2: lidar\.model = 'vlp64': must be one of \"vlp16\"" '[[lidar]]\nmodel = "vlp64"\n'
broken "two [[lidar]] tables" "$file:3: lidar: this release takes exactly one \[\[lidar\]\]$" \
  '[[lidar]]\nmodel = "vlp16"\n[[lidar]]\nmodel = "hdl32e"\n'
broken "a transform of two numbers" \
  "$file:2: lidar\.T_base_lidar\.xyz_m = \[1, 2\]: must be three numbers from -1000 to 1000$" \
  '[[lidar]]\nT_base_lidar = { xyz_m = [1, 2], rpy_deg = [0, 0, 0] }\n'
broken "a key that millimetres slipped into" "$file:2: lidar\.T_base_lidar\.xyz_mm = .*; did you mean lidar\.T_base_lidar\.xyz_m\?$" \
  '[[lidar]]\nT_base_lidar = { xyz_mm = [1, 2, 3] }\n'
broken "what is no TOML" "$file:2: not TOML: " '[odometry]\nseed = = 3\n'
broken "a value of several lines, in one line" "$file:2: lidar\.model = .*vlp 16.*: must be one of" \
  '[[lidar]]\nmodel = "vlp\\n16"\n'

# set_to WHAT PATTERN KEY=VALUE
set_to() {
  refuses "$1" 2 "^slamd-replay: $2" "$bin/slamd-replay" --out "$scratch/out_dir" --set "$3" "$recording"
}
set_to "--set of an unknown key" "--set odometry\.sed=3: unknown key; did you mean odometry\.seed\?$" odometry.sed=3
set_to "--set of a value out of range" "--set odometry\.seed = -1: must be a whole number from 0 to 1000000000$" odometry.seed=-1
set_to "--set without a value" "--set odometry\.seed: must be key=value$" odometry.seed

refuses "a configuration file that is not there" 2 "^slamd-replay: $scratch/none\.toml: cannot be read$" \
  "$bin/slamd-replay" --out "$scratch/out_dir" --config "$scratch/none.toml" "$recording"
refuses "a bare capture without configuration" 2 "^slamd-replay: .*lidar\.pcap: has no recording\.toml" \
  "$bin/slamd-replay" --out "$scratch/out_dir" "$recording/lidar.pcap"
printf '[odometry]\nseed = 2\n' >"$recording/recording.toml"
refuses "a recording without a model" 2 "^slamd-replay: .*recording\.toml: lidar\.model: missing; must be one of \"vlp16\"" \
  "$bin/slamd-replay" --out "$scratch/out_dir" "$recording"
check "nothing was written for any of them" test ! -e "$scratch/out_dir"

# Round trip of --print-config, in two steps: what is printed says the same, and says all.
printf '[[lidar]]\nmodel = "vlp16"\nT_base_lidar = { xyz_m = [100, 0, 0.3], rpy_deg = [12.5, -90, 3] }\n[imu]\nsource = "a \\"b\\".csv"\n' \
  >"$recording/recording.toml"
touch "$recording/a \"b\".csv"
"$bin/slamd-replay" --print-config --set odometry.recovery_deg=7.3 "$recording" >"$scratch/printed.toml"
"$bin/slamd-replay" --print-config --config "$scratch/printed.toml" "$recording" >"$scratch/again.toml"
check "--print-config reads back as the same configuration" cmp "$scratch/printed.toml" "$scratch/again.toml"
check "--print-config holds what --set said" grep -qx 'recovery_deg = 7.3' "$scratch/printed.toml"
for shipped in config/*.toml; do
  check "$shipped loads" "$bin/slamd-replay" --print-config --config "$shipped" --set imu.enabled=false "$recording/lidar.pcap"
done
exit "$status"
