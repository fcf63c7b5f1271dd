#!/usr/bin/env bash
# The daemon for SLAMD_SOAK_SECONDS (15; tools/check --full: 600) with a VLP-16 and a 400 Hz IMU, then with an Avia: no
# heap call in its real-time threads from their first instruction on, no scan dropped, every packet accounted for. Needs
# root for the namespaces; drops mean something on a quiet machine only. SLAMD_SOAK_DRIVES: folder of drives to use,
# vlp16/ and livox_avia/, in place of simulated ones.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq ip
. tests/system/network.bash
seconds=${SLAMD_SOAK_SECONDS:-15}
watch=$(realpath "$bin/../lib/libslamd_heap_watch.so")

# no_heap_calls LIDAR COUNTS
no_heap_calls() {
  local thread calls
  for thread in receive preproc odometry publish; do
    calls=$(awk -v name="slamd-$thread" '$1 == name { print $2 + $3, $4 }' "$2")
    if [ "$calls" = "0 -" ]; then
      pass "$1: no heap call in the $thread thread"
    else
      fail "$1: heap calls in the $thread thread, and the first caller: '$calls'"
    fi
  done
  # The watch itself: the thread that keeps house allocates, and must be seen to.
  if awk '$1 == "main" && $2 > 1000 { seen = 1 } END { exit !seen }' "$2"; then
    pass "$1: the watch sees the heap calls of housekeeping"
  else
    fail "$1: the watch sees nothing: $(cat "$2")"
  fi
}

# soak LIDAR IMU_SOURCE
soak() {
  local lidar=$1 imu=$2 work=$scratch/$1 drive=${SLAMD_SOAK_DRIVES:-$scratch/$1}/$1 sent daemon
  mkdir -p "$work"
  if [ ! -d "$drive" ]; then
    "$bin/slamd-simulate" --out "$drive" --lidar "$lidar" --seed 21 --duration "$seconds" --imu-rate 400 >/dev/null ||
      { fail "$lidar: simulated"; return; }
  fi
  grep -v '^source' "$drive/recording.toml" >"$work/slamd.toml"
  [ "$imu" = livox ] && sed -i '/^T_base_imu/d' "$work/slamd.toml"
  ip netns exec slamd_host env LD_PRELOAD="$watch" SLAMD_HEAP_WATCH="$work/heap.txt" \
    "$bin/slamd" --config "$work/slamd.toml" --set "imu.source=$imu" 2>"$work/slamd.log" &
  daemon=$!
  pids+=("$daemon")
  listens "$work/slamd.log"
  local feed=()
  [ "$imu" = udp ] && feed=(--imu-to udp:10.77.0.1:7501)
  sent=$(on_sensor "$bin/slamd-replay" --to-network 10.77.0.1 "${feed[@]}" --json "$drive") || fail "$lidar: the drive was re-sent"
  sleep 1.2  # the last health that counts
  on_host "$bin/slamd-status" --once --json >"$work/health.json"
  kill -TERM "$daemon"
  if wait "$daemon"; then pass "$lidar: slamd ends cleanly after $(jq -r '.took_s | floor' <<<"$sent") s"; else fail "$lidar: slamd ends cleanly"; fi
  no_heap_calls "$lidar" "$work/heap.txt"
  accounted_for "$lidar" "$sent" "$work/slamd.log"
  local dropped=".health.counters | .scans_skipped + .scans_dropped + .blocks_dropped + .kernel_lost"
  if [ "$(jq "$dropped" "$work/health.json")" = 0 ]; then
    pass "$lidar: none of $(jq .health.counters.scans "$work/health.json") scans dropped, none of $(jq .sent.lidar <<<"$sent") packets lost"
  else
    fail "$lidar: $(jq -c .health.counters "$work/health.json")"
  fi
  echo "$lidar: $(jq -c '{counters: .health.counters, stages: .health.stages, state: .health.state}' "$work/health.json")"
  grep -E '^[WI] ' "$work/slamd.log" | grep -vE 'STARTING|heard|listening' | tail -n 15
}

soak vlp16 udp
soak livox_avia livox
exit "$status"
