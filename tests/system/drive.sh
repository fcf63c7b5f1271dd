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

# begin LIDAR IMU_SOURCE [SIMULATOR ARGUMENT...]: a simulator that waits for commands, slamd, and a listener to its poses.
begin() {
  local lidar=$1 imu=$2
  shift 2
  work=$scratch/$lidar
  "$bin/slamd-simulate" --drive 127.0.0.1 --lidar "$lidar" --seed 3 --duration 60 --json --out "$work" "$@" \
    >"$work.json" 2>"$work.err" &
  simulator=$!
  wait_for "$work/recording.toml"
  grep -v '^source' "$work/recording.toml" >"$work.toml"
  "$bin/slamd" --config "$work.toml" --set imu.source="$imu" 2>"$work.log" &
  daemon=$!
  "$bin/slamd-status" --json --tum "$work.tum" >/dev/null &
  listener=$!
  pids+=("$simulator" "$daemon" "$listener")
  sleep 4  # at rest, to find gravity
}

# end: all three; judges how the simulator ends and how near the poses were to the truth.
end() {
  local offset
  check "$(basename "$work"): slamd is TRACKING at the end" "$bin/slamd-status" --once --json
  for pid in "$listener" "$daemon"; do
    kill -TERM "$pid"
    wait "$pid"
  done
  kill -TERM "$simulator"
  if wait "$simulator"; then pass "Ctrl-C ends a drive well"; else fail "Ctrl-C ends a drive well: $(cat "$work.err")"; fi
  offset=$(jq ".wall_minus_recorded_s | -." "$work.json")
  "$bin/slamd-evaluate" --json --offset="$offset" "$work/truth.tum" "$work.tum" >"$work.ape.json"
  holds "$(basename "$work"): slamd's live poses follow the truth within 10 cm ($(jq .ape_m.se3.rmse "$work.ape.json") m rms)" \
    "$work.ape.json" ".ape_m.se3.rmse < 0.1"
}

# A drive of straight line, turn, arc and return.
begin vlp16 udp --imu-to udp:127.0.0.1:7501 --imu-rate 400
drive 1 0 4     # 4 s at 1 m/s, less what accelerating at 0.8 and braking at 1.5 m/s² cost: 3.71 m
sleep 1.5
drive 0 0.8 2   # 1.6 rad to the left
sleep 1.5
drive 0.8 0.4 3
sleep 1.5
drive -0.6 0 2
sleep 1.5
end

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
holds "each command was heard, and nothing was hit" "$work.json" ".commands.heard >= 113 and .commands.malformed == 0 and .collisions == 0"
holds "packets were sent in real time" "$work.json" ".took_s - .recording_s < 0.1 and .lateness_ms.mean < 20"

check "the recording of the drive is mapped" "$bin/slamd-replay" --out "$scratch/map" "$work"
holds "and its map's poses follow the truth within 10 cm" "$scratch/map/report.json" ".accuracy.psf.ape_rmse_m | numbers < 0.1"

# The other LiDARs: an Avia with its own inertial samples, a Mid-360 with a sensor of its own on UDP.
for sensors in "livox_avia livox" "livox_mid360 udp --imu-to udp:127.0.0.1:7501 --imu-rate 200"; do
  # shellcheck disable=SC2086 # words
  begin $sensors
  drive 1 0 3
  sleep 1.5
  drive 0.8 0.4 3
  sleep 1.5
  end
done

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
