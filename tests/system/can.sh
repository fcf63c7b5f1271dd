#!/usr/bin/env bash
# The daemon with an inertial sensor and wheels on a CAN bus, on a kernel that has CAN: user-mode Linux. A drive is played
# onto the bus and the network; the pose is compared with the truth; the bus goes down, off, away, and comes back.
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
. tests/system/verdicts.bash
needs jq cansend
. tests/system/uml.bash

for protocol in xsens aceinna; do
  drive=$scratch/$protocol
  "$bin/slamd-simulate" --out "$drive" --lidar vlp16 --seed 23 --duration 7 --rest 2 --imu-rate 400 --can "$protocol" >/dev/null || fail "$protocol: simulated"
  grep -v '^source' "$drive/recording.toml" >"$drive/slamd.toml"
done

mkdir "$scratch/live"
cp "$scratch/xsens/slamd.toml" "$scratch/live/"

# What runs on the computer with the bus; what it finds out, it leaves in files.
cat >"$scratch/guest.sh" <<'END'
daemon() {
  "$bin/slamd" --config "$scratch/$1/slamd.toml" --set odometry.filter=iekf --set lcm.scan_points=0 --set imu.source=can --set imu.interface=vcan0 --set wheel.source=can \
    --set wheel.interface=vcan0 2>"$scratch/$1/log" &
  slamd=$!
  until_health '.health.uptime_ns >= 0' "$scratch/heard.json"
}
end_daemon() { kill -TERM "$slamd"; wait "$slamd"; echo $? >"$scratch/$1/code"; }
drive() {
  daemon "$1"
  "$bin/slamd-status" --url 'udpm://239.255.76.67:7667?ttl=0&recv_buf_size=8388608' --json --tum "$scratch/$1/live.tum" >/dev/null &
  local listener=$!
  for _ in $(seq 50); do [ -e "$scratch/$1/live.tum" ] && break; sleep 0.1; done
  sleep 0.5
  "$bin/slamd-replay" --to-network 127.0.0.1 --can-to vcan0 --json "$scratch/$1" >"$scratch/$1/sent.json"
  "$bin/slamd-status" --once --json >"$scratch/$1/health.json"
  kill -TERM "$listener"; wait "$listener"
}
# until_health FILTER FILE: waits for what the jq filter says of health, up to 8 s; leaves what there was.
until_health() {
  for _ in $(seq 40); do
    "$bin/slamd-status" --once --json >"$2"
    jq -e "$1" "$2" >/dev/null 2>&1 && return
    sleep 0.1
  done
}
{ "$tests/test_drivers_transport" --gtest_filter='CanKernel.*' && "$tests/test_daemon_pipeline" --gtest_filter='CanLoop.*'; } >"$scratch/kernel" 2>&1
echo $? >"$scratch/kernel.code"

drive aceinna
end_daemon aceinna

daemon live
"$bin/slamd-simulate" --drive 127.0.0.1 --lidar vlp16 --duration 6 --rest 2 --imu-rate 400 --can xsens --can-to vcan0 --json >"$scratch/live/sent.json"
"$bin/slamd-status" --once --json >"$scratch/live/health.json"
end_daemon live

drive xsens
until_health '.health.causes | map(startswith("imu: silent")) | any' "$scratch/silent.json"
cansend vcan0 20000040#0000000000000000
ip link set vcan0 down
until_health '.health.causes | map(startswith("vcan0: is down")) | any' "$scratch/down.json"
ip link del vcan0
until_health '.health.causes | map(startswith("vcan0: no such interface")) | any' "$scratch/absent.json"
ip link add dev vcan0 type vcan && ip link set vcan0 up
until_health '.health.causes | map(startswith("vcan0")) | any | not' "$scratch/back.json"
for tick in 00002710 00002729 00002742; do
  cansend vcan0 "005#$tick"; cansend vcan0 032#000000000000; cansend vcan0 034#0000000009D0
done
cansend vcan0 1A0#00000000
sleep 0.3
end_daemon xsens

"$bin/slamd-replay" --to-network 127.0.0.1 --can-to vcan0 "$scratch/xsens" >/dev/null 2>&1 &
player=$!
"$bin/slamd-sensors" --no-serial --seconds 2.4 --json --write "$scratch/found.toml" | tail -n 1 >"$scratch/found.json"
kill "$player"
echo 212992 >/proc/sys/net/core/rmem_max
setpriv --bounding-set=-net_admin "$bin/slamd-sensors" --no-serial --seconds 1.2 --json | tail -n 1 >"$scratch/small.json"
END
began=$(date +%s%N)
{ echo "bin=$bin scratch=$scratch tests=$(realpath "$bin/../tests")"; cat "$scratch/guest.sh"; } >"$scratch/guest"
if in_uml 100 "$scratch/guest" >"$scratch/console"; then pass "user-mode Linux ran it all in $((($(date +%s%N) - began) / 1000000)) ms"; else
  fail "user-mode Linux ran it all"
  tail -n 10 "$scratch/console"
fi

if [ "$(cat "$scratch/kernel.code" 2>/dev/null)" = 127 ]; then
  skip "test_drivers_transport or test_daemon_pipeline is not built"
elif [ "$(cat "$scratch/kernel.code" 2>/dev/null)" = 0 ] && ! grep -q SKIPPED "$scratch/kernel"; then
  pass "$(grep -c '  OK' "$scratch/kernel") tests of socket and receive thread: filters, stamps, overflow counted exactly, errors, slcan, no allocation"
else
  fail "tests of socket and receive thread"
  grep -E 'Failure|FAILED|SKIPPED' -A 4 "$scratch/kernel" | head -n 20
fi

# says WHAT PATTERN PROTOCOL: the daemon's log has such a line.
says() { if grep -qE "$2" "$scratch/$3/log"; then pass "$1"; else fail "$1: the log has no line like '$2': $(tail -n 4 "$scratch/$3/log")"; fi; }
# inertial PROTOCOL SAMPLES: so many were made of the frames. Nothing but its arrival tells which two of an Aceinna's frames
# are one: where this computer holds the sender up between them, both are told to be incomplete.
inertial() {
  local sample incomplete
  sample=$(sed -nE 's/^I inertial: sample ([0-9]+).*/\1/p' "$scratch/$1/log")
  incomplete=$(sed -nE 's/^I inertial: .*incomplete ([0-9]+).*/\1/p' "$scratch/$1/log")
  if [ "$1" = xsens ] && [ "$sample" = $(($2 + 3)) ] && [ -z "$incomplete" ]; then
    pass "$1: all $2 inertial samples are there"
  elif [ "$1" = aceinna ] && [ $((2 * sample + incomplete)) -ge $((2 * $2 - 1)) ] && [ "$sample" -gt $(($2 * 8 / 10)) ]; then
    pass "$1: $sample of $2 inertial samples are there, and the others' frames are counted"
  else
    fail "$1: $sample of $2 inertial samples are there, and $incomplete frames were incomplete"
  fi
}
# punctual PROTOCOL: the sender had the processor when it needed it. Nothing on the bus tells when a wheel turned or an
# Aceinna measured: where this computer is busy with other things, their stamps are as late as the frames, and so would be
# the pose.
punctual() {
  local late
  late=$(jq -c '.lateness_ms | [.mean, .worst] | map(round)' "$scratch/$1/sent.json")
  if jq -e '.lateness_ms | .mean < 40 and .worst < 400' "$scratch/$1/sent.json" >/dev/null; then return 0; fi
  skip "$1: the pose is not judged, for this computer was too busy: frames went out $late ms late (mean, worst)"
  return 1
}
# judge_pose PROTOCOL: the wheels were used, and the pose is where it should be.
judge_pose() {
  local drive=$scratch/$1 used offset ape poses
  used=$(sed -nE 's/^I wheels: .*used ([0-9]+).*/\1/p' "$drive/log")
  if [ "${used:-0}" -gt 200 ]; then pass "$1: the odometry used $used samples of the wheels"; else fail "$1: the odometry used '$used' samples of the wheels"; fi
  offset=$(jq .wall_minus_recorded_s "$drive/sent.json")
  ape=$("$bin/slamd-evaluate" --json --offset="-$offset" "$drive/truth.tum" "$drive/live.tum" | jq .ape_m.se3.rmse)
  # Of the poses the listener may miss some: it is the last that this computer gives its one processor to.
  poses=$(wc -l <"$drive/live.tum")
  if [ "$poses" -gt 100 ] && [ -n "$ape" ] && awk "BEGIN { exit !($ape < 0.05) }"; then
    pass "$1: $poses poses lie $ape m rms from the truth"
  else
    fail "$1: $poses poses lie '$ape' m rms from the truth"
  fi
}
for protocol in aceinna xsens; do
  drive=$scratch/$protocol
  sent=$(jq .sent.can_frames "$drive/sent.json")
  samples=$(($(wc -l <"$drive/imu.csv") - 1))
  more=$([ "$protocol" = xsens ] && echo 10 || echo 0)  # of what came in by hand, afterwards
  says "$protocol: all $sent CAN frames that were sent are read" "^I can: received $((sent + more))(,|$)" "$protocol"
  inertial "$protocol" "$samples"
  holds "$protocol: a pose for every inertial sample since it was levelled" "$drive/health.json" \
    '.health | (.counters.poses > 2000 and .counters.kernel_lost == 0)'
  holds "$protocol: three sensors are heard" "$drive/health.json" '.health.sensors | length == 3 and (map(.received > 300) | all)'
  if punctual "$protocol"; then judge_pose "$protocol"; fi
  if [ "$(cat "$drive/code")" = 0 ]; then pass "$protocol: slamd ends cleanly"; else fail "$protocol: slamd ends with $(cat "$drive/code")"; fi
done

sent=$(jq .sent.can_frames "$scratch/live/sent.json")
says "live: all $sent CAN frames that the simulator sent are read" "^I can: received $sent(,|$)" live
holds "live: three sensors are heard, and a pose for every inertial sample since it was levelled" "$scratch/live/health.json" \
  '.health | (.counters.poses > 1500 and (.sensors | length == 3 and (map(.received > 200) | all)))'

holds "that nothing comes any more is said" "$scratch/silent.json" '.health.causes | map(startswith("imu: silent")) | any'
holds "that the interface is down is said" "$scratch/down.json" '.health.causes | map(startswith("vcan0: is down")) | any'
holds "that it is gone is said" "$scratch/absent.json" '.health.causes | map(startswith("vcan0: no such interface")) | any'
holds "that it is back is seen" "$scratch/back.json" '.health.causes | map(startswith("vcan0")) | any | not'
holds "slamd-sensors finds the inertial sensor on the bus, and the wheels' frames" "$scratch/found.json" \
  '.buses[] | select(.interface == "vcan0") | .xsens.samples.last_second > 300 and any(.ids[]; .id == 416 and .frames.last_second > 40)'
holds "and says that receive buffers are too small" "$scratch/small.json" \
  '[.remarks[] | select(.about == "receive buffers")] | length == 1 and (.[0].words | test("^receive buffer of [0-9]+ bytes instead of 4194304 .*net.core.rmem_max"))'
check "slamd accepts the configuration that it writes" "$bin/slamd-replay" --print-config --config "$scratch/found.toml" "$scratch/xsens/lidar.pcap"
check "which has the sensor on the bus" grep -q '^interface = "vcan0"' "$scratch/found.toml"
says "bus off is told, with the interface's name" '^I receive: vcan0: bus off' xsens
says "and counted" '^I can: .*bus_off 1' xsens
exit "$status"
