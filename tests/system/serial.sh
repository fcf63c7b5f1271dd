#!/usr/bin/env bash
# The daemon with a LiDAR on the network and an emulated inertial sensor on a serial line: found, configured, counted to
# the last sample, unplugged and plugged in again. Needs root for the network namespaces.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq ip
. tests/system/network.bash

line=$scratch/by-id-imu
prefix=SERIAL
health() { on_host "$bin/slamd-status" --once --json --prefix "$prefix"; }
# comes WHAT FILTER: the jq filter is true of health within 10 s.
comes() {
  local said
  for _ in $(seq 20); do
    said=$(health)
    if jq -e "$2" <<<"$said" >/dev/null 2>&1; then pass "$1"; return; fi
    sleep 0.5
  done
  fail "$1: $(jq -c '.health | [.state, .causes]' <<<"$said")"
}
# daemon TOML SETTING...: begins one on the host; its log is $log.
daemon() {
  local settings=()
  for setting in "${@:2}"; do settings+=(--set "$setting"); done
  log=$scratch/$prefix.log
  ip netns exec slamd_host "$bin/slamd" --config "$1" --set imu.source=serial --set "imu.device=$line" \
    --set "lcm.prefix=$prefix" "${settings[@]}" 2>"$log" &
  pids+=("$!")
  slamd=$!
}
end_daemon() {
  kill -TERM "$slamd"
  if wait "$slamd"; then pass "$prefix: slamd ends cleanly"; else fail "$prefix: slamd ends with an error"; fi
}
says() { if grep -qE "$2" "$log"; then pass "$1"; else fail "$1: the log has no line like '$2': $(tail -n 5 "$log")"; fi; }

# A drive: every sample that the sensor has sent is read, and live and replay agree.
drive() {
  local protocol=$1 sent offset ape listener
  shift
  prefix=SERIAL_$protocol
  daemon "$scratch/slamd.toml" "imu.protocol=$protocol" "$@"
  ip netns exec slamd_host "$bin/slamd-status" --json --prefix "$prefix" --tum "$scratch/live.tum" >/dev/null &
  listener=$!
  pids+=("$listener")
  sleep 0.7
  sent=$(on_sensor "$bin/slamd-replay" --to-network 10.77.0.1 --imu-to "$protocol:$line" --json "$scratch/drive") ||
    fail "$protocol: the drive was sent"
  sleep 0.3
  kill -TERM "$listener"; wait "$listener"
  end_daemon
  accounted_for "$protocol" "$sent" "$log"
  local count; count=$(jq .sent.imu_rows <<<"$sent")
  says "$protocol: all $count samples that were sent are read" "^I inertial: sample $count(,|$)"
  says "$protocol: odometry begins" 'odometry begins'
  offset=$(jq .wall_minus_recorded_s <<<"$sent")
  ape=$("$bin/slamd-evaluate" --json --offset="$offset" "$scratch/live.tum" "$scratch/replay/odometry.tum" | jq .ape_m.none.rmse)
  if [ -n "$ape" ] && [ "$ape" != null ] && awk "BEGIN { exit !($ape < 0.02) }"; then
    pass "$protocol: live and replay agree within 2 cm ($ape m rms)"
  else
    fail "$protocol: live and replay differ by '$ape' m rms"
  fi
}
"$bin/slamd-simulate" --out "$scratch/drive" --lidar vlp16 --seed 23 --duration 7 --imu-rate 400 >/dev/null || fail "simulated"
grep -v '^source' "$scratch/drive/recording.toml" >"$scratch/slamd.toml"
"$bin/slamd-replay" --out "$scratch/replay" "$scratch/drive" >/dev/null 2>&1 || fail "replayed"
drive xsens
drive mip

# At rest, with a sensor that is looked for at all rates, told what to send, unplugged and plugged in again. The LiDAR
# goes on meanwhile; what the sensor's own sender has for a LiDAR goes nowhere.
prefix=SERIAL_REST
"$bin/slamd-simulate" --out "$scratch/rest" --lidar vlp16 --seed 24 --duration 26 --rest 25 --imu-rate 400 >/dev/null || fail "simulated at rest"
daemon "$scratch/slamd.toml" imu.protocol=xsens imu.baud=0 imu.rate_hz=200
plug_in() {
  ip netns exec slamd_host "$bin/slamd-replay" --to-network 127.0.0.1:9:9 --imu-to "xsens:$line" "$scratch/rest" >/dev/null 2>&1 &
  pids+=("$!")
  sender=$!
}
on_sensor "$bin/slamd-replay" --to-network 10.77.0.1 "$scratch/rest" >/dev/null &
pids+=("$!")
comes "without its sensor it waits" '.health.causes | index("imu: nothing received yet") != null'
plug_in
comes "the sensor is plugged in: TRACKING" '.health.state == "TRACKING"'
comes "it sends as much of what it was told to as a line of 115,200 baud carries" '.health.sensors[] | select(.name == "imu") | (.rate_hz > 95 and .rate_hz < 105)'
says "the rate was found" 'serial: the inertial sensor is heard at 115200 baud'
says "the sensor was configured" 'serial: the inertial sensor is configured: 100 samples a second'
kill -KILL "$sender"; wait "$sender" 2>/dev/null
comes "the sensor is unplugged: said" '.health.causes | map(startswith("imu: silent for")) | any'
says "the log says that the port is gone" 'serial: the serial port is gone'
rm -f "$line"  # as udev does
began=$(date +%s%N)
plug_in
comes "the sensor is plugged in again: TRACKING" '.health.state == "TRACKING"'
echo "back after $(((($(date +%s%N) - began)) / 1000000)) ms"
if [ "$(grep -c 'is configured: 100' "$log")" -eq 2 ]; then pass "it was configured twice"; else fail "it was not configured twice"; fi
end_daemon
exit "$status"
