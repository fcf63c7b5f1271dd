#!/usr/bin/env bash
# slamd and Livox devices on a network: emulated ones in a namespace of their own, which slamd finds, sets and starts; a
# cable that is pulled and put back, also while the vehicle drives on, a device that is switched off and on, a daemon that is killed: each time back to
# TRACKING without a hand. Needs root for the namespaces.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq ip
. tests/system/network.bash
ip -n slamd_sensor route add 224.0.0.0/4 dev lo  # for the simulator's truth

space=slamd_host  # whose daemon is asked
now_ms() { date +%s%3N; }
health() { ip netns exec "$space" "$bin/slamd-status" --once --json 2>/dev/null; }

# tracking_again WHAT SECONDS [BEGAN]: the daemon says TRACKING, and its sensors run, within so long of now or BEGAN;
# says how long it took.
tracking_again() {
  local began=${3:-$(now_ms)} said
  while [ $(($(now_ms) - began)) -lt $((1000 * $2)) ]; do
    said=$(health)
    if [ -n "$said" ] && jq -e '.health.state == "TRACKING" and all(.health.sensors[]; .state == "running")' <<<"$said" >/dev/null 2>&1; then
      pass "$lidar: $1: TRACKING after $(awk "BEGIN { printf \"%.1f\", ($(now_ms) - $began) / 1000 }") s"
      echo "$said" >"$work/health.json"
      return
    fi
    sleep 0.1
  done
  fail "$lidar: $1: not TRACKING within $2 s: $(jq -c '[.health.state, .health.causes]' <<<"$said")"
  tail -n 5 "$log"
  return 1
}

# back_to_tracking, likewise, of a vehicle that stands still: the pose has to be where it was.
back_to_tracking() {
  tracking_again "$@" &&
    holds "$lidar: $1: the pose is where it was" "$work/health.json" '.pose.T_odom_base.position_m | map(. * .) | add | sqrt < 0.2'
}

# drive_on: the vehicle drives on for 3 s at 0.5 m/s while the cable is out; slamd has to find where it is by itself.
drive_on() {
  ip netns exec slamd_sensor "$bin/slamd-status" --truth "$work/truth.tum" >/dev/null &
  local listener=$!
  pids+=("$listener")
  on_sensor "$bin/slamd-ctl" drive 0.5 0 5 &  # begins to drive while slamd tracks
  local driver=$!
  pids+=("$driver")
  sleep 2
  ip -n slamd_host link set slamd_a down
  wait "$driver"
  sleep 0.5
  ip -n slamd_host link set slamd_a up
  tracking_again "drove on while it was unplugged for 3.5 s" 20
  sleep 0.5
  health >"$work/health.json"
  kill -TERM "$listener"; wait "$listener"
  # From where it began, in the axes of the vehicle then, as odom's are.
  awk 'NR == 1 { x = $2; y = $3; yaw = 2 * atan2($7, $8) }
       END { c = cos(yaw); s = sin(yaw); dx = $2 - x; dy = $3 - y
             printf "[%.3f, %.3f]\n", c * dx + s * dy, c * dy - s * dx }' "$work/truth.tum" >"$work/truth.json"
  jq -c --slurpfile truth "$work/truth.json" '{truth: $truth[0], pose: .pose.T_odom_base.position_m[:2]} |
    . + {off_m: ([.truth, .pose] | transpose | map(.[0] - .[1] | . * .) | add | sqrt)}' "$work/health.json" >"$work/off.json"
  holds "$lidar: the vehicle has gone on" "$work/off.json" '.truth | map(. * .) | add | sqrt > 1.5'
  holds "$lidar: the pose is the truth's within 0.3 m: $(cat "$work/off.json")" "$work/off.json" '.off_m < 0.3'
}

# cause_is WHAT PATTERN SECONDS: health names a cause like this within so long.
cause_is() {
  local said='' i
  for ((i = 0; i < 5 * $3; ++i)); do
    said=$(health | jq -r '.health.causes | join("; ")')
    [[ "$said" =~ $2 ]] && { pass "$lidar: $1: '$said'"; return; }
    sleep 0.1
  done
  fail "$lidar: $1: health says '$said', not like '$2'"
}

# logs WHAT PATTERN FILE: a line of the log is like this.
logs() { if grep -qE "$2" "$3"; then pass "$lidar: the log says $1"; else fail "$lidar: no line like '$2'"; fi; }

switch_on() {
  ip netns exec slamd_sensor "$bin/slamd-simulate" --live --lidar "$lidar" --seed 5 --duration 600 "$@" \
    >/dev/null 2>>"$work/device.log" &
  device=$!
  pids+=("$device")
}
start_daemon() {
  log=$1
  ip netns exec "$space" "$bin/slamd" --config "$work/slamd.toml" 2>"$log" &
  daemon=$!
  pids+=("$daemon")
}

# configure LIDAR CODE
configure() {
  lidar=$1 work=$scratch/$1
  mkdir -p "$work"
  cat >"$work/slamd.toml" <<TOML
[[lidar]]
model = "$lidar"
device.code = "$2"
T_base_lidar = { xyz_m = [0.0, 0.0, 0.3] }
[imu]
source = "livox"
TOML
}

# keep LIDAR CODE: everything that happens to one device.
keep() {
  configure "$@"
  start_daemon "$work/first.log"
  cause_is "no device is there" 'searching|not to be heard' 8
  switch_on --device-extrinsic 0.1,-0.2,0.3,0,0,90
  back_to_tracking "switched on" 20

  ip -n slamd_host link set slamd_a down
  sleep 4.5
  ip -n slamd_host link set slamd_a up
  back_to_tracking "unplugged for 4.5 s, plugged in again" 20

  kill -9 "$device"; wait "$device" 2>/dev/null
  cause_is "switched off" 'lost, looked for again|not to be heard' 8
  switch_on
  back_to_tracking "switched off and on" 20

  if [ "$lidar" = livox_avia ]; then drive_on; fi

  kill -9 "$daemon"; wait "$daemon" 2>/dev/null
  local started
  started=$(now_ms)
  start_daemon "$work/second.log"
  back_to_tracking "slamd was killed, and starts" 20 "$started"
  # An Avia goes on sending to the daemon that died, until it misses its heartbeats and looks for a host.
  for ((i = 0; i < 100; ++i)); do grep -q ' samples$' "$log" && break; sleep 0.1; done
  back_to_tracking "kept by the slamd that was started" 15 "$started"

  kill -TERM "$daemon"
  if wait "$daemon"; then pass "$lidar: slamd ends cleanly"; else fail "$lidar: slamd ends with an error"; fi
  kill -TERM "$device"; wait "$device"
  logs "how many packets the device sent" 'the device sent [0-9]{4,} packets, and kept [0-9]{3,} that no host wanted' "$work/device.log"
  logs "that the device was connected" "$2 at 10\.77\.0\.2 is connected" "$work/first.log"
  logs "what extrinsic it has stored" "$2 has an extrinsic stored: xyz_m = \[0\.100, -0\.200, 0\.300\], rpy_deg = \[0, 0, 90\]; it is not what lidar\.T_base_lidar says, and slamd ignores it" "$work/first.log"
  if [ "$(grep -c "$2 has an extrinsic stored" "$work/first.log")" -eq 1 ]; then pass "$lidar: once, though it was connected twice"; else fail "$lidar: the log repeats the extrinsic"; fi
  logs "that no extrinsic is stored" "$2 has no extrinsic stored$" "$work/second.log"
  logs "that it was lost" "$2 at 10\.77\.0\.2 was lost" "$work/first.log"
  logs "that it samples for the second daemon" "$2 samples" "$work/second.log"
  logs "that it was let go" "$2 was stopped" "$work/second.log"
}

keep livox_avia 3JEDK380010Z391
keep livox_mid360 47MDL1234567890
# Two computers hear the same Avia: one has it, the other says so, and takes it when the first has died.
configure livox_avia any
start_daemon "$work/host.log"
host=$daemon
space=slamd_sensor
start_daemon "$work/sensor.log"
sensor=$daemon
switch_on
for ((i = 0; i < 100; ++i)); do grep -qs ' is held by another host' "$work/host.log" "$work/sensor.log" && break; sleep 0.1; done
loser=sensor winner=$host
grep -q ' is held by another host' "$work/host.log" && { loser=host winner=$sensor; }
space=slamd_$loser log=$work/$loser.log
cause_is "the computer that comes too late says why" 'livox_avia: held by another host' 5
started=$(now_ms)
kill -9 "$winner"; wait "$winner" 2>/dev/null
back_to_tracking "the daemon that held it was killed, the other takes it" 20 "$started"

refuses "a Velodyne plays no device" 2 'vlp16 has nothing to say to a host' "$bin/slamd-simulate" --live --lidar vlp16
refuses "nor does slamd talk to one" 2 'lidar\.device\.code = "any": slamd talks to Livox devices only' \
  "$bin/slamd" --set lidar.model=vlp16 --set lidar.device.code=any
exit "$status"
