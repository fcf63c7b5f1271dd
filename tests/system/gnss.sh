#!/usr/bin/env bash
# The daemon with a LiDAR on the network and an emulated satellite receiver on a serial line: found, counted to the last
# fix in each of its tongues, unplugged and plugged in again; and with a receiver behind the LiDAR. Needs root for the
# network namespaces.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq ip
. tests/system/network.bash

line=$scratch/by-id-gnss
prefix=GNSS
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
exit "$status"
