#!/usr/bin/env bash
# The daemon with a LiDAR on the network and an emulated satellite receiver on a serial line: found, counted to the last
# fix in each of its tongues, unplugged and plugged in again; with a receiver behind the LiDAR; and with an emulated Avia
# that is told the receiver's UTC, with and without PPS. Needs root for the network namespaces.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq ip
. tests/system/network.bash

ip -n slamd_sensor route add 224.0.0.0/4 dev lo  # for the simulator's truth

line=$scratch/by-id-gnss
prefix=GNSS
health() { on_host "$bin/slamd-status" --once --json --prefix "$prefix"; }
# comes WHAT FILTER: the jq filter is true of health within 10 s.
comes() {
  local said
  for _ in $(seq 20); do
    said=$(health)
    if [ -n "$said" ] && jq -e "$2" <<<"$said" >/dev/null 2>&1; then pass "$1"; return; fi
    sleep 0.5
  done
  fail "$1: $(jq -c '.health | [.state, .causes]' <<<"$said")"
}
# daemon SETTING...: begins one on the host; its log is $log.
daemon() {
  local settings=()
  for setting in "$@"; do settings+=(--set "$setting"); done
  log=$scratch/$prefix.log
  ip netns exec slamd_host "$bin/slamd" --config "$scratch/slamd.toml" --set imu.enabled=false --set "lcm.prefix=$prefix" \
    "${settings[@]}" 2>"$log" &
  pids+=("$!")
  slamd=$!
}
end_daemon() {
  kill -TERM "$slamd"
  if wait "$slamd"; then pass "$prefix: slamd ends cleanly"; else fail "$prefix: slamd ends with an error"; fi
}
says() { if grep -qE "$2" "$log"; then pass "$1"; else fail "$1: the log has no line like '$2': $(tail -n 5 "$log")"; fi; }
# plug_in TONGUE: a receiver at the host's terminal for the length of the drive.
plug_in() {
  ip netns exec slamd_host "$bin/slamd-replay" --to-network 127.0.0.1:9:9 --gnss-to "$1:$line" --json "$scratch/drive" \
    >"$scratch/sent" 2>/dev/null &
  pids+=("$!")
  receiver=$!
}

"$bin/slamd-simulate" --out "$scratch/drive" --lidar vlp16 --seed 23 --duration 8 >/dev/null || fail "simulated"
grep -v '^source' "$scratch/drive/recording.toml" >"$scratch/slamd.toml"

for tongue in nmea ubx both; do
  prefix=GNSS_$tongue
  daemon gnss.source=serial "gnss.device=$line" gnss.baud=38400
  plug_in "$tongue"
  wait "$receiver"
  sleep 0.3
  end_daemon
  told=$(jq '.sent.gnss_fixes' "$scratch/sent")
  heard=$(sed -nE 's/^I gnss: fix //p' "$log" | tr ',' '\n' | awk '{ sum += $NF } END { print sum + 0 }')
  if [ "${told:-0}" -gt 20 ] && [ "$told" = "$heard" ]; then
    pass "$tongue: all $told fixes that were told are heard"
  else
    fail "$tongue: $told fixes were told, $heard are heard: $(grep gnss "$log")"
  fi
done

prefix=GNSS_REST
daemon gnss.source=serial "gnss.device=$line"
comes "without its receiver it says so" '.health.causes | index("gnss: no GNSS bytes yet") != null'
plug_in both
comes "the receiver is plugged in: its fixes are counted" '.health.sensors[] | select(.name == "gnss") | (.state == "running" and .received > 3)'
comes "quality and satellites stand in health" '.health.counters | (.gnss_quality == 1 and .gnss_satellites > 3 and .gnss_age_ms < 1000)'
says "the rate was found" 'gnss: the receiver is heard at [0-9]+ baud'
kill -KILL "$receiver"; wait "$receiver" 2>/dev/null
comes "the receiver is unplugged: said" '.health.causes | map(startswith("gnss: no GNSS bytes for")) | any'
says "the log says that the port is gone" 'gnss: the serial port is gone'
rm -f "$line"  # as udev does
plug_in nmea
comes "the receiver is plugged in again: nothing is missing" '.health.causes | map(startswith("gnss")) | any | not'
end_daemon

prefix=GNSS_LIDAR
daemon gnss.source=velodyne
on_sensor "$bin/slamd-replay" --to-network 10.77.0.1 "$scratch/drive" >/dev/null &
pids+=("$!")
comes "the receiver behind the LiDAR is heard" '.health.sensors[] | select(.name == "gnss") | .received > 2'
end_daemon

# utc NAME [SIMULATOR ARGUMENT...]: an Avia is switched on, with a receiver that nobody has plugged in yet; a daemon whose
# LiDAR's clock is "shared" is to tell it the UTC.
utc() {
  prefix=$1
  shift
  cat >"$scratch/slamd.toml" <<TOML
[[lidar]]
model = "livox_avia"
clock = "shared"
device.code = "any"
device.set_utc = true
T_base_lidar = { xyz_m = [0.0, 0.0, 0.3] }
TOML
  rm -f "$line"
  ip netns exec slamd_sensor "$bin/slamd-simulate" --live --lidar livox_avia --seed 5 --duration 600 --json \
    --gnss-to "nmea:$scratch/antenna" "$@" >"$scratch/$prefix.json" 2>"$scratch/$prefix.device" &
  device=$!
  pids+=("$device")
  for ((i = 0; i < 100; ++i)); do [ -e "$scratch/antenna" ] && break; sleep 0.1; done
  cat "$scratch/antenna" >/dev/null &  # somebody else's
  listener=$!
  pids+=("$listener")
  daemon gnss.source=serial "gnss.device=$line" gnss.baud=38400
}
plug_in_antenna() {
  kill "$listener"; wait "$listener" 2>/dev/null
  ln -s "$scratch/antenna" "$line"
}
end_utc() {
  end_daemon
  kill -TERM "$device"
  wait "$device"
}
tracks='(.health.state == "TRACKING" and (.health.sensors[] | select(.name == "livox_avia") | .state == "running"))'

utc AVIA_NO_PPS
comes "an Avia whose receiver is not plugged in yet: said" '.health.causes | index("gnss: no GNSS bytes yet") != null'
plug_in_antenna
comes "an Avia without PPS: health says what it lacks" '.health.causes | index("livox_avia: hears no PPS, and so cannot use the UTC that it is told") != null'
sleep 3
says "the log says that it was told the time" '3JEDK380010Z391 was told the time'
end_utc
holds "it was told three seconds or more, and could use none" "$scratch/AVIA_NO_PPS.json" '.device.utc | .told >= 3 and .told == .unused'

utc AVIA_PPS --pps
comes "an Avia with PPS that nobody tells the UTC: TRACKING, and health says what it lacks" \
  "$tracks"' and (.health.causes | index("livox_avia: follows PPS, but has taken no UTC yet") != null)'
says "the log says that it follows PPS" '3JEDK380010Z391 says: synchronised by pps'
plug_in_antenna
comes "it was told the UTC: nothing is missing" '.health.causes == [] and '"$tracks"
sleep 3
comes "its stamps are the wall clock's time, as they were within each second: no step, TRACKING throughout" \
  "$tracks"' and (.health.sensors[0] | .time == "shared" and .time_steps == 0 and (.time_residual_us | fabs) < 50000)'
end_utc
says "the log says that it follows GPS" '3JEDK380010Z391 says: synchronised by gps'
if [ "$(grep -c 'odometry: TRACKING' "$log")" -eq 1 ]; then pass "it was TRACKING from then on"; else fail "it was not TRACKING throughout: $(grep odometry: "$log")"; fi
holds "it was told each second, and few came too early for it" "$scratch/AVIA_PPS.json" '.device.utc | .told >= 3 and .unused <= 2'
if [ "$(grep -c 'the device follows' "$scratch/AVIA_PPS.device")" -eq 2 ]; then
  pass "the device followed PPS, then GPS"
else
  fail "the device followed PPS, then GPS: $(cat "$scratch/AVIA_PPS.device")"
fi
exit "$status"
