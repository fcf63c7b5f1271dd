#!/usr/bin/env bash
# The driven simulator: velocity commands on LCM move a vehicle in real time, slamd maps what its sensors send, and the
# truth says whether both did as they should. In a network namespace of its own, which needs root.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq ip unshare
if [ -z "${SLAMD_DRIVE_ALONE:-}" ]; then
  if ! unshare --net true 2>/dev/null; then
    skip "a network namespace needs root"
    exit 0
  fi
  SLAMD_DRIVE_ALONE=1 exec unshare --net "$0" "$@"
fi
ip link set lo up
ip route add 224.0.0.0/4 dev lo

pids=()
finish() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null; done
  wait 2>/dev/null
  rm -rf "$scratch"
}
trap finish EXIT
drive() { "$bin/slamd-ctl" drive "$@"; }
# wait_for FILE: until something is in it.
wait_for() { for ((i = 0; i < 100; ++i)); do [ -s "$1" ] && return; sleep 0.1; done; }

# A drive of straight line, turn, arc and return, with slamd listening.
work=$scratch/town
"$bin/slamd-simulate" --drive 127.0.0.1 --imu-to udp:127.0.0.1:7501 --imu-rate 400 --seed 3 --duration 60 --json \
  --out "$work" >"$scratch/drive.json" 2>"$scratch/drive.err" &
simulator=$!
pids+=("$simulator")
wait_for "$work/recording.toml"
grep -v '^source' "$work/recording.toml" >"$scratch/slamd.toml"
"$bin/slamd" --config "$scratch/slamd.toml" --set imu.source=udp 2>"$scratch/slamd.log" &
daemon=$!
"$bin/slamd-status" --json --tum "$scratch/live.tum" >"$scratch/status.log" &
listener=$!
pids+=("$daemon" "$listener")
sleep 4  # at rest, to find gravity
drive 1 0 4     # 4 s at 1 m/s, less what accelerating at 0.8 and braking at 1.5 m/s² cost: 3.71 m
sleep 1.5
drive 0 0.8 2   # 1.6 rad to the left
sleep 1.5
drive 0.8 0.4 3
sleep 1.5
drive -0.6 0 2
sleep 1.5
"$bin/slamd-status" --once --json >"$scratch/health.json"
state=$?
kill -TERM "$listener"
wait "$listener"
kill -TERM "$daemon"
wait "$daemon"
kill -TERM "$simulator"
if wait "$simulator"; then pass "Ctrl-C ends a drive well"; else fail "Ctrl-C ends a drive well: $(cat "$scratch/drive.err")"; fi

# What the vehicle did: way and turn of each phase, from the truth.
awk 'function wrapped(a) { return atan2(sin(a), cos(a)) }
     { yaw = 2 * atan2($7, $8)
       if (NR > 1) {
         d = sqrt(($2 - x) ^ 2 + ($3 - y) ^ 2)
         w = wrapped(yaw - last)
         moving = d > 2e-5 || w > 2e-5 || w < -2e-5
         if (moving && still > 30) ++phase
         still = moving ? 0 : still + 1
         if (phase) { way[phase] += d; turn[phase] += w }
       }
       x = $2; y = $3; last = yaw }
     END { for (i = 1; i <= phase; ++i) printf "{\"way_m\":%.3f,\"turn_rad\":%.3f}\n", way[i], turn[i] }' \
  "$work/truth.tum" | jq -sc . >"$scratch/phases.json"
cat "$scratch/phases.json"
near() { echo "((. - $1) | fabs) < $2"; }
holds "the vehicle moved four times, as it was told" "$scratch/phases.json" "length == 4"
holds "4 s at 1 m/s lead 3.71 m straight ahead" "$scratch/phases.json" ".[0] | (.way_m | $(near 3.71 0.15)) and (.turn_rad | $(near 0 0.02))"
holds "2 s at 0.8 rad/s turn by 1.6 rad on the spot" "$scratch/phases.json" ".[1] | (.way_m | $(near 0 0.02)) and (.turn_rad | $(near 1.6 0.12))"
holds "0.8 m/s and 0.4 rad/s are an arc to the left" "$scratch/phases.json" ".[2] | (.way_m | $(near 2.21 0.15)) and (.turn_rad | $(near 1.2 0.1))"
holds "2 s at -0.6 m/s lead back" "$scratch/phases.json" ".[3] | (.way_m | $(near 1.10 0.12)) and (.turn_rad | $(near 0 0.02))"
holds "each command was heard, and nothing was hit" "$scratch/drive.json" ".commands.heard >= 113 and .commands.malformed == 0 and .collisions == 0"
holds "packets were sent in real time" "$scratch/drive.json" ".took_s - .recording_s < 0.1 and .lateness_ms.mean < 20"

# What slamd made of it.
[ "$state" -eq 0 ] && pass "slamd is TRACKING at the end" || fail "slamd is TRACKING at the end: $(head -c 300 "$scratch/health.json")"
offset=$(jq ".wall_minus_recorded_s | -." "$scratch/drive.json")
"$bin/slamd-evaluate" --json --offset="$offset" "$work/truth.tum" "$scratch/live.tum" >"$scratch/live.json"
holds "slamd's live poses follow the truth within 10 cm ($(jq .ape_m.se3.rmse "$scratch/live.json") m rms)" "$scratch/live.json" ".ape_m.se3.rmse < 0.1"
check "the recording of the drive is mapped" "$bin/slamd-replay" --out "$scratch/map" "$work"
holds "and its map's poses follow the truth within 10 cm" "$scratch/map/report.json" ".accuracy.ape_m.se3.rmse < 0.1"

# The other LiDARs: an Avia with its own inertial samples, a Mid-360 with a sensor of its own on UDP.
# follows LIDAR IMU_SOURCE [SIMULATOR ARGUMENT...]
follows() {
  local lidar=$1 imu=$2 simulator daemon listener offset
  shift 2
  "$bin/slamd-simulate" --drive 127.0.0.1 --lidar "$lidar" --seed 3 --duration 30 --json --out "$scratch/$lidar" "$@" \
    >"$scratch/$lidar.json" 2>"$scratch/$lidar.err" &
  simulator=$!
  wait_for "$scratch/$lidar/recording.toml"
  grep -v '^source' "$scratch/$lidar/recording.toml" >"$scratch/$lidar.toml"
  "$bin/slamd" --config "$scratch/$lidar.toml" --set imu.source="$imu" 2>"$scratch/$lidar.log" &
  daemon=$!
  "$bin/slamd-status" --json --tum "$scratch/$lidar.tum" >/dev/null &
  listener=$!
  pids+=("$simulator" "$daemon" "$listener")
  sleep 4
  drive 1 0 3
  sleep 1.5
  drive 0.8 0.4 3
  sleep 1.5
  check "$lidar: slamd is TRACKING at the end" "$bin/slamd-status" --once --json
  for pid in "$listener" "$daemon" "$simulator"; do
    kill -TERM "$pid"
    wait "$pid"
  done
  offset=$(jq ".wall_minus_recorded_s | -." "$scratch/$lidar.json")
  "$bin/slamd-evaluate" --json --offset="$offset" "$scratch/$lidar/truth.tum" "$scratch/$lidar.tum" >"$scratch/$lidar.ape.json"
  holds "$lidar: live poses follow the truth within 10 cm ($(jq .ape_m.se3.rmse "$scratch/$lidar.ape.json") m rms)" \
    "$scratch/$lidar.ape.json" ".ape_m.se3.rmse < 0.1"
}
follows livox_avia livox
follows livox_mid360 udp --imu-to udp:127.0.0.1:7501 --imu-rate 200

# Into a wall.
"$bin/slamd-simulate" --drive 127.0.0.1 --world indoor --duration 14 --json --drop 5% --out "$scratch/wall" \
  >"$scratch/wall.json" 2>"$scratch/wall.err" &
simulator=$!
pids+=("$simulator")
wait_for "$scratch/wall/recording.toml"
sleep 0.5
drive 1.6 0.3 8
wait "$simulator" && pass "a drive ends after its time" || fail "a drive ends after its time"
holds "the vehicle stops at the wall, which is counted once" "$scratch/wall.json" ".collisions == 1"
if [ "$(grep -c 'collision 1 at .* the vehicle stopped' "$scratch/wall.err")" -eq 1 ]; then pass "and is said"; else fail "and is said: $(cat "$scratch/wall.err")"; fi
holds "faults work while driving, too" "$scratch/wall/faults.json" '.packets.velodyne_data | .dropped > 200 and .written + .dropped == .read'
refuses "--drive refuses a destination that is none" 2 '--drive 127.0.0.1:x.*|port x' "$bin/slamd-simulate" --drive 127.0.0.1:x
exit "$status"
