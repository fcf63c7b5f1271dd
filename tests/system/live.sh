#!/usr/bin/env bash
# The daemon on a network: a drive is re-sent in real time from one network namespace to another, and what a subscriber
# hears is compared with the replay of the same recording. Needs root for the namespaces.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq ip
seconds=${SLAMD_LIVE_SECONDS:-25}

. tests/system/network.bash

# live LIDAR IMU_SOURCE [SECONDS]: maps a drive live and as a replay, and compares.
live() {
  local lidar=$1 imu=$2 seconds=${3:-$seconds} work=$scratch/$1 daemon listener sent
  mkdir -p "$work"
  "$bin/slamd-simulate" --out "$work/drive" --lidar "$lidar" --seed 21 --duration "$seconds" --imu-rate 400 >/dev/null ||
    { fail "$lidar: simulated"; return; }
  local set=(--set "imu.source=$imu")
  grep -v '^source' "$work/drive/recording.toml" >"$work/slamd.toml"
  [ "$imu" = livox ] && sed -i '/^T_base_imu/d' "$work/slamd.toml"

  ip netns exec slamd_host "$bin/slamd" --config "$work/slamd.toml" "${set[@]}" 2>"$work/slamd.log" &
  daemon=$!
  ip netns exec slamd_host "$bin/slamd-status" --json --tum "$work/live.tum" >"$work/status.log" &
  listener=$!
  pids+=("$daemon" "$listener")
  sleep 1
  local feed=()
  [ "$imu" = udp ] && feed=(--imu-to udp:10.77.0.1:7501)
  if sent=$(on_sensor "$bin/slamd-replay" --to-network 10.77.0.1 "${feed[@]}" --json "$work/drive"); then
    pass "$lidar: the drive was re-sent"
  else
    fail "$lidar: the drive was re-sent"
  fi
  sleep 1.2  # the last health that counts
  on_host "$bin/slamd-status" --once --json >"$work/health.json"
  kill -TERM "$listener"; wait "$listener"
  kill -TERM "$daemon"
  if wait "$daemon"; then pass "$lidar: slamd ends cleanly on SIGTERM"; else fail "$lidar: slamd ends cleanly on SIGTERM"; fi

  accounted_for "$lidar" "$sent" "$work/slamd.log"  # sender = received + counted, exactly
  # The subscriber hears the poses.
  local told heard
  told=$(jq .health.counters.poses "$work/health.json")
  heard=$(grep -c . "$work/live.tum")
  if [ -n "$told" ] && [ "$heard" -gt 1000 ] && [ $((1000 * heard)) -ge $((999 * told)) ]; then
    pass "$lidar: a subscriber hears $heard of $told poses"
  else
    fail "$lidar: a subscriber hears $heard of $told poses"
  fi
  # Live and replay agree.
  "$bin/slamd-replay" "${set[@]}" --out "$work/replay" "$work/drive" >/dev/null 2>"$work/replay.log" || fail "$lidar: replayed: $(cat "$work/replay.log")"
  local offset ape
  offset=$(jq .wall_minus_recorded_s <<<"$sent")
  ape=$("$bin/slamd-evaluate" --json --offset="$offset" "$work/live.tum" "$work/replay/odometry.tum" | jq .ape_m.none.rmse)
  if [ -n "$ape" ] && [ "$ape" != null ] && awk "BEGIN { exit !($ape < 0.02) }"; then
    pass "$lidar: live and replay agree within 2 cm ($ape m rms)"
  else
    fail "$lidar: live and replay differ by '$ape' m rms"
  fi
}

live vlp16 udp
live livox_avia livox
live livox_mid360 livox 12

# A second daemon finds the port taken, and says by whom.
printf '[[lidar]]\nmodel = "vlp16"\n' >"$scratch/lone.toml"
ip netns exec slamd_host "$bin/slamd" --config "$scratch/lone.toml" 2>/dev/null &
first=$!
pids+=("$first")
sleep 0.7
text=$(on_host timeout 10 "$bin/slamd" --config "$scratch/lone.toml" --set lcm.prefix=OTHER 2>&1)
code=$?
if [ "$code" -eq 1 ] && [[ "$text" == *2368* && "$text" == *"pid $first"* ]]; then
  pass "a port that is taken: exit 1, names the other process"
else
  fail "a port that is taken: exit $code, says '$text'"
fi
# Two daemons, two prefixes, two ports: side by side.
ip netns exec slamd_host "$bin/slamd" --config "$scratch/lone.toml" --set lcm.prefix=OTHER --set lidar.port=2369 --set lidar.position_port=8309 2>/dev/null &
pids+=("$!")
sleep 0.7
on_host "$bin/slamd-status" --once --prefix OTHER >"$scratch/other.txt"
if [ $? -eq 3 ] && grep -q 'nothing received yet' "$scratch/other.txt"; then
  pass "a second daemon with a prefix of its own says that it waits for its sensor"
else
  fail "a second daemon with a prefix of its own: $(head -n 3 "$scratch/other.txt")"
fi
exit "$status"
