#!/usr/bin/env bash
# The daemon on a network: a drive is re-sent in real time from one network namespace to another, and what a subscriber
# hears is compared with the replay of the same recording; a client of the map must have the daemon's. Needs root for the namespaces.
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
  # Two clients of the map: one from the start, one that joins late.
  local url='udpm://239.255.76.67:7667?ttl=0' clients=()
  ip netns exec slamd_host "$bin/../tests/map_watch" "$url" SLAMD "$seconds" >"$work/map.json" &
  clients+=("$!")
  (sleep $((seconds / 2)); exec ip netns exec slamd_host "$bin/../tests/map_watch" "$url" SLAMD 5) >"$work/late.json" &
  clients+=("$!")
  pids+=("${clients[@]}")
  listens "$work/slamd.log"
  sleep 0.5
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

  wait "${clients[@]}"
  map_is_whole "$lidar: a client" "$work/map.json"
  map_is_whole "$lidar: a client that joins late" "$work/late.json"
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

# map_is_whole WHAT FILE: the client's map is the daemon's, block by block, which their digests say, or was within the last
# second, for the drive may end amid an update; at most 1 MB/s.
map_is_whole() {
  local said
  said=$(jq -r '"whole after \(.complete_after_s) s, longest gap \(.longest_gap_s) s, \(.bytes_per_s / 1000 | round) kB/s, \(.occupied) cells occupied, \(.free) free, \(.requests) requests"' "$2")
  if [ -s "$2" ] && jq -e '(.complete or .incomplete_s < 1) and .differs == 0 and .malformed == 0 and .occupied > 100 and .free > 1000 and .bytes_per_s < 1000000' "$2" >/dev/null; then
    pass "$1 has the daemon's map: $said"
  else
    fail "$1 has not the daemon's map: $(cat "$2")"
  fi
}

live vlp16 udp
live livox_avia livox
live livox_mid360 livox 12

# cause_is WHAT PATTERN: health names a cause like this within 6 s.
cause_is() {
  local said=
  for _ in 1 2 3 4 5 6 7 8 9 10 11 12; do
    said=$(on_host "$bin/slamd-status" --once --json --prefix COME | jq -r '.health.causes | join("; ")')
    [[ "$said" =~ $2 ]] && { pass "$1: '$said'"; return; }
    sleep 0.5
  done
  fail "$1: health says '$said', not like '$2'"
}
# state_is WHAT STATE: health is in this state within 6 s.
state_is() {
  local state=
  for _ in 1 2 3 4 5 6 7 8 9 10 11 12; do
    state=$(on_host "$bin/slamd-status" --once --json --prefix COME | jq -r .health.state)
    [ "$state" = "$2" ] && { pass "$1"; return; }
    sleep 0.5
  done
  fail "$1: health says $state, not $2"
}
# logs WHAT PATTERN COUNT: so many lines of the log are like this.
logs() {
  local count
  count=$(grep -cE "$2" "$work/slamd.log")
  if [ "$count" -eq "$3" ]; then pass "$1"; else fail "$1: $count lines like '$2', not $3"; fi
}
ask() { on_host "$bin/slamd-ctl" --prefix COME "$@"; }

# A sensor that is absent at first, comes, goes and comes back; and meanwhile the commands.
come_and_go() {
  local work=$scratch/come daemon listener sending
  mkdir -p "$work/saved"
  "$bin/slamd-simulate" --out "$work/drive" --lidar vlp16 --seed 22 --duration 14 --imu-rate 400 >/dev/null || { fail "come and go: simulated"; return; }
  grep -v '^source' "$work/drive/recording.toml" >"$work/slamd.toml"
  ip netns exec slamd_host "$bin/slamd" --config "$work/slamd.toml" --set imu.source=udp --set lcm.prefix=COME \
    --set "output.save_directory=$work/saved" --set "mapping.session_directory=$work/sessions" 2>"$work/slamd.log" &
  daemon=$!
  ip netns exec slamd_host "$bin/slamd-status" --json --prefix COME >"$work/status.log" &
  listener=$!
  pids+=("$daemon" "$listener")
  listens "$work/slamd.log"
  sleep 0.3
  cause_is "a sensor that is absent at the start" 'vlp16: nothing received yet; imu: nothing received yet'
  refuses_ "a save before there is a map" 'there is no map yet' save early
  refuses_ "a set-pose before there is a pose" 'there is no pose yet' set-pose 1 2 0 90
  refuses_ "a seal, for there is no black box" 'no black box' seal
  ip netns exec slamd_sensor "$bin/slamd-replay" --to-network 10.77.0.1 --imu-to udp:10.77.0.1:7501 "$work/drive" >/dev/null &
  sending=$!
  state_is "the sensor appears: TRACKING" TRACKING
  sleep 2
  check "set-pose moves map" ask set-pose 10 20 0 90
  check "save writes what there is" ask save first
  refuses_ "a second save of the same name" 'is there already' save first
  points=$(head -n 8 "$work/saved/first/map.ply" | awk '/^element vertex/ { print $3 + 0 }')
  if [ "${points:-0}" -gt 1000 ] && [ "$(stat -c %s "$work/saved/first/map.ply")" -ge $((12 * points)) ]; then
    pass "the map that was saved has $points points"
  else
    fail "the map that was saved has '$points' points"
  fi
  # The drive has gone a few metres by now: the trajectory, in map, ends near where set-pose put it.
  if tail -n 1 "$work/saved/first/trajectory.tum" | awk '{ d = ($2 - 10)^2 + ($3 - 20)^2 } END { exit !(NF == 8 && d < 9) }'; then
    pass "the trajectory that was saved is in map"
  else
    fail "the trajectory that was saved ends at $(tail -n 1 "$work/saved/first/trajectory.tum")"
  fi
  check "new-map is taken" ask new-map
  state_is "new-map: STARTING until odom is level" STARTING
  wait "$sending"
  cause_is "the sensor disappears" 'vlp16: silent for [0-9.]+ s; imu: silent for [0-9.]+ s'
  sleep 3.5  # now it may come back with another address
  ip -n slamd_sensor addr flush dev slamd_b
  ip -n slamd_sensor addr add 10.77.0.9/24 dev slamd_b
  ip netns exec slamd_sensor "$bin/slamd-replay" --to-network 10.77.0.1 --imu-to udp:10.77.0.1:7501 "$work/drive" >/dev/null
  ip -n slamd_sensor addr flush dev slamd_b
  ip -n slamd_sensor addr add 10.77.0.2/24 dev slamd_b
  kill -KILL "$daemon"  # as the kernel or a power failure may: the sessions are there all the same
  kill -TERM "$listener"
  wait "$listener" "$daemon"
  "$bin/slamd-map" info --json "$(ls -d "$work"/sessions/*Z* | head -n 1)" >"$work/first.json"
  "$bin/slamd-map" info --json "$(ls -d "$work"/sessions/*Z* | tail -n 1)" >"$work/last.json"
  holds "the session before new-map was closed" "$work/first.json" '.closed and .keyframes > 0 and .damage == []'
  holds "the session of a killed daemon opens, and holds its map" "$work/last.json" '(.closed | not) and .keyframes > 0 and .lost_records == 0'
  if jq -es 'map(.pose.reset_counter // 0) | max >= 1' "$work/status.log" >/dev/null; then
    pass "new-map increments the reset counter"
  else
    fail "new-map does not increment the reset counter: $(tail -n 1 "$work/status.log" | jq -c .pose)"
  fi
  logs "the log says who is heard first" 'the LiDAR is heard, from 10.77.0.2' 1
  logs "the log says that it fell silent" 'the LiDAR has fallen silent' 1
  logs "the log says that it returned, from elsewhere" 'the LiDAR is heard, from 10.77.0.9' 1
  logs "the log says that the inertial sensor came and came back" 'the inertial sensor is heard' 2
  logs "the log says that a new map was ordered" 'a new map was ordered' 1
  logs "the log says where odom began, twice" 'odometry begins' 2
  if [ "$(wc -l <"$work/slamd.log")" -lt 100 ]; then pass "the log is short"; else fail "the log has $(wc -l <"$work/slamd.log") lines"; fi
}
# refuses_ WHAT PATTERN COMMAND...: slamd-ctl is refused with these words.
refuses_() {
  local what=$1 pattern=$2 said
  shift 2
  if said=$(ask "$@" 2>&1); then fail "$what: is not refused"; return; fi
  if [[ "$said" =~ $pattern ]]; then pass "$what is refused: '$said'"; else fail "$what is refused, but '$said'"; fi
}
come_and_go

# A second daemon finds the port taken, and says by whom.
printf '[[lidar]]\nmodel = "vlp16"\n' >"$scratch/lone.toml"
ip netns exec slamd_host "$bin/slamd" --config "$scratch/lone.toml" 2>"$scratch/lone.log" &
first=$!
pids+=("$first")
listens "$scratch/lone.log"
text=$(on_host timeout 10 "$bin/slamd" --config "$scratch/lone.toml" --set lcm.prefix=OTHER 2>&1)
code=$?
if [ "$code" -eq 1 ] && [[ "$text" == *2368* && "$text" == *"pid $first"* ]]; then
  pass "a port that is taken: exit 1, names the other process"
else
  fail "a port that is taken: exit $code, says '$text'"
fi
# Two daemons, two prefixes, two ports: side by side.
ip netns exec slamd_host "$bin/slamd" --config "$scratch/lone.toml" --set lcm.prefix=OTHER --set lidar.port=2369 --set lidar.position_port=8309 2>"$scratch/other.log" &
pids+=("$!")
listens "$scratch/other.log"
on_host "$bin/slamd-status" --once --prefix OTHER >"$scratch/other.txt"
if [ $? -eq 3 ] && grep -q 'nothing received yet' "$scratch/other.txt"; then
  pass "a second daemon with a prefix of its own says that it waits for its sensor"
else
  fail "a second daemon with a prefix of its own: $(head -n 3 "$scratch/other.txt")"
fi
exit "$status"
