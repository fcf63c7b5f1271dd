#!/usr/bin/env bash
# SLAMD_GARBAGE_SECONDS (20; tools/check --full: 300) of garbage against the ASan build of slamd, on every port: data,
# position and inertial datagrams from the sensor's own address and from a stranger's, bytes at the serial port, whatever
# at LCM's group; with a good drive in between. Two daemons at once: VLP-16 with the IMU over UDP, and Avia with a serial
# IMU. Then slamd-sensors hears the same. Needs root for the namespaces, and the ASan builds of both.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq ip
seconds=${SLAMD_GARBAGE_SECONDS:-20}
asan=$(realpath -m "${SLAMD_ASAN:-build/asan/bin/slamd}")
garbage=$(realpath -m "$bin/../tests/slamd_garbage")
sensors="$(dirname "$asan")/slamd-sensors"
if [ ! -x "$asan" ] || [ ! -x "$sensors" ]; then
  skip "no ASan build (cmake --preset asan && cmake --build --preset asan --target slamd slamd-sensors)"
  exit 0
fi
. tests/system/network.bash
ip -n slamd_sensor addr add 10.77.0.3/24 dev slamd_b  # the stranger
export ASAN_OPTIONS=detect_stack_use_after_return=1 UBSAN_OPTIONS=print_stacktrace=1

declare -A daemon_of
# begin NAME MODEL EXTRA_TOML: a daemon on the bus as NAME.
begin() {
  local name=$1 lidar=$2
  mkdir -p "$scratch/$name/saved"
  "$bin/slamd-simulate" --out "$scratch/$name/drive" --lidar "$lidar" --seed 5 --duration 20 --imu-rate 400 >/dev/null || fail "$name: simulated"
  printf '[[lidar]]\nmodel = "%s"\nport = %s\n%b' "$lidar" "$3" "$4" >"$scratch/$name/slamd.toml"
  ip netns exec slamd_host "$asan" --config "$scratch/$name/slamd.toml" --set "lcm.prefix=$name" 2>"$scratch/$name/slamd.log" &
  daemon_of[$name]=$!
  pids+=("$!")
}
begin VELO vlp16 2368 '[imu]\nsource = "udp"\nport = 7501\n'
begin AVIA livox_avia 56001 "[imu]\nsource = \"serial\"\ndevice = \"$scratch/imu\"\n"
listens "$scratch/VELO/slamd.log"
listens "$scratch/AVIA/slamd.log"

# Good packets, for ever: the sensor's address gets pinned, and what is damaged gets past the first checks.
good() { while :; do on_sensor "$bin/slamd-replay" --to-network "$@" >/dev/null 2>&1 || break; done; }
good 10.77.0.1:2368:8308 --imu-to udp:10.77.0.1:7501 "$scratch/VELO/drive" &
pids+=("$!")
good 10.77.0.1:56001 "$scratch/AVIA/drive" &
pids+=("$!")
senders=()
# throw WHERE SEED KIND ARGUMENT...
throw() {
  local space=$1
  shift
  ip netns exec "$space" "$garbage" "$seconds" "$@" >"$scratch/count.$1" &
  senders+=("$!")
  pids+=("$!")
}
throw slamd_sensor 1 udp "$scratch/VELO/drive" 10.77.0.2 10.77.0.1 2368 8308 7501
throw slamd_sensor 2 udp "$scratch/VELO/drive" 10.77.0.3 10.77.0.1 2368 8308 7501
throw slamd_sensor 3 udp "$scratch/AVIA/drive" 10.77.0.2 10.77.0.1 56001
throw slamd_sensor 4 udp "$scratch/AVIA/drive" 10.77.0.3 10.77.0.1 56001
throw slamd_host 5 pty "$scratch/AVIA/drive" "$scratch/imu"
throw slamd_host 6 lcm VELO
throw slamd_host 7 lcm AVIA
for sender in "${senders[@]}"; do wait "$sender" || fail "garbage is sent"; done
echo "$(cat "$scratch"/count.* | awk '{ sum += $1 } END { print sum }') pieces of garbage in $seconds s"
sleep 3  # the limit of commands a second has passed

complains() { grep -qE 'ERROR: |runtime error|SUMMARY' "$1"; }

# answers NAME: a refusal is an answer, too: after a new-map among the garbage there may be no pose yet.
answers() {
  local said
  said=$(on_host "$bin/slamd-ctl" --prefix "$1" --timeout 5 set-pose 1 2 0 90 2>&1) || [[ $said == refused:* ]]
  local answered=$?
  echo "$said"
  return "$answered"
}

for name in VELO AVIA; do
  check "$name: answers a command after $seconds s of garbage" answers "$name"
  on_host "$bin/slamd-status" --once --json --prefix "$name" >"$scratch/$name.json"
  holds "$name: refused some of it, by count" "$scratch/$name.json" '.health.sensors[0].dropped > 0'
  holds "$name: took the good packets in between" "$scratch/$name.json" '.health.sensors[0].received > 1000'
  kill -TERM "${daemon_of[$name]}"
  if wait "${daemon_of[$name]}"; then pass "$name: ends cleanly"; else fail "$name: ends with an error"; fi
  if complains "$scratch/$name/slamd.log"; then
    fail "$name: the sanitizer complains"
    grep -E 'ERROR: |runtime error|SUMMARY' -A12 "$scratch/$name/slamd.log" | head -n 40
  else
    pass "$name: the sanitizers have no complaint"
  fi
  grep -E '^I (packets|blocks):' "$scratch/$name/slamd.log"
  echo "$name: $(wc -l <"$scratch/$name/slamd.log") lines of log"
done

# Their ports are free now, and the good packets still come.
seconds=8
ip netns exec slamd_host "$sensors" --seconds 10 --json --no-serial --port 7501 --write "$scratch/found.toml" \
  >"$scratch/seen.json" 2>"$scratch/sensors.log" &
listener=$!
pids+=("$listener")
throw slamd_sensor 8 udp "$scratch/VELO/drive" 10.77.0.2 10.77.0.1 2368 8308 7501
throw slamd_sensor 9 udp "$scratch/AVIA/drive" 10.77.0.2 10.77.0.1 56001
if wait "$listener"; then pass "slamd-sensors: ends cleanly"; else fail "slamd-sensors: ends with an error"; fi
if complains "$scratch/sensors.log"; then fail "slamd-sensors: the sanitizer complains"; head -n 40 "$scratch/sensors.log"; else pass "slamd-sensors: the sanitizers have no complaint"; fi
tail -n 1 "$scratch/seen.json" >"$scratch/seen_last.json"
holds "slamd-sensors: found both LiDARs in it" "$scratch/seen_last.json" '[.lidars[] | select(.packets.total > 1000)] | length == 2'
check "slamd-sensors: wrote a configuration that slamd takes" "$bin/slamd" --check --config "$scratch/found.toml"
exit "$status"
