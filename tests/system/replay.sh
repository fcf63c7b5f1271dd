#!/usr/bin/env bash
# slamd-replay on drives that slamd-simulate makes: the same bytes each time and under load, the report that scripts
# rely on, exit codes, accuracy, and captures that are cut off or hold foreign packets.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq

replay=$bin/slamd-replay
cd "$scratch" || exit 1

# Two processes that do nothing but burn both cores, for a minute and a half at most.
start_load() {
  timeout 90 sh -c 'while :; do :; done' &
  load=($!)
  timeout 90 sh -c 'while :; do :; done' &
  load+=($!)
}
end_load() {
  kill "${load[@]}" 2>/dev/null
  wait "${load[@]}" 2>/dev/null
}

check "a drive with a VLP-16 is simulated" "$bin/slamd-simulate" --out vlp16 --seed 11 --duration 30 --rest 3
check "a drive with an Avia is simulated" "$bin/slamd-simulate" --out avia --lidar livox_avia --seed 12 --duration 12 --rest 3
check "the VLP-16 drive replays, with a second filter beside it" "$replay" --out vlp16_one --compare iekf vlp16
check "the Avia drive replays, with a second filter beside it" "$replay" --out avia_one --compare iekf avia
start_load
check "the VLP-16 drive replays while both cores are busy" "$replay" --out vlp16_two vlp16
check "the Avia drive replays while both cores are busy" "$replay" --out avia_two avia
end_load
for lidar in vlp16 avia; do
  for file in odometry.tum trajectory.tum map.ply session/000000.slamd; do
    check "$lidar: $file is the same to the byte under load" cmp "${lidar}_one/$file" "${lidar}_two/$file"
  done
  check "$lidar: the map holds points" test "$(head -c 200 "${lidar}_one/map.ply" | awk '/^element vertex/ { print $3 }')" -gt 10000
  report=${lidar}_one/report.json
  holds "$lidar: report.json has all keys of the contract" "$report" \
    '(.state | type == "string") and ([.scans, .scans_dropped, .rss_max_mb, .realtime_factor] | all(type == "number")) and
     ([.packets, .stage_ms, .states] | all(type == "object")) and
     ([.cpu_ms_per_scan, .stage_ms.odometry] | all([.median, .p95, .p99, .max] | all(type == "number"))) and
     ([.swarm.small, .swarm.recovery, .swarm.won] | all(type == "number")) and
     ([.loops.candidates, .loops.verified, .loops.accepted, .loops.removed] | all(type == "number")) and
     (.states | to_entries | all((.value.time_s | type == "number") and (.value.causes | type == "object")))'
  holds "$lidar: each scan is accounted for and none refused" "$report" \
    '.state == "TRACKING" and .scans > 80 and .scans_dropped == 0 and
     (.packets | to_entries | all(.value == 0 or (.key | test("^(data|points|imu|position)$"))))'
  check "$lidar: one pose a scan in odometry.tum" \
    test "$(wc -l <"${lidar}_one/odometry.tum")" -eq "$(jq .scans "$report")"
  check "$lidar: report.html is a whole page" grep -q '</html>' "${lidar}_one/report.html"
  for estimate in odometry.tum odometry-iekf.tum; do
    "$bin/slamd-evaluate" --json "$lidar/truth.tum" "${lidar}_one/$estimate" >"$lidar.json"
    holds "$lidar: $estimate lies within 5 cm of the truth (APE, $(jq '.ape_m.se3.rmse // .ape_m.yaw.rmse' "$lidar.json") m)" \
      "$lidar.json" '(.ape_m.se3.rmse // .ape_m.yaw.rmse) < 0.05 and .pairs > 80'
  done
done

# The session that a replay keeps, and what slamd-map makes of it.
map=$bin/slamd-map
"$map" info --json vlp16_one/session >session.json
holds "slamd-map finds the session whole" session.json \
  '.closed and .keyframes > 5 and .points > 10000 and (.damage | length) == 0 and .lost_records == 0'
check "slamd-map exports it" "$map" export vlp16_one/session --ply map.ply --pcd map.pcd --tum way.tum --top top.png --slice slice.png --grid floor
check "the grid has walls, free ground and the unknown" sh -c \
  'tail -c +20 floor.pgm | od -An -v -tu1 -w1 | sort -u | tr -d " " | tr "\n" " " | grep -qx "0 205 254 "'
check "keyframes lie on the trajectory" "$bin/slamd-evaluate" vlp16_one/trajectory.tum way.tum
check "slamd-map runs its graph again" "$map" optimise vlp16_one/session --out optimised
head -c $(($(stat -c %s vlp16_one/session/000000.slamd) * 2 / 3)) vlp16_one/session/000000.slamd >cut.slamd
mkdir cut_session && mv cut.slamd cut_session/000000.slamd
"$map" info --json cut_session >session.json
holds "slamd-map reads what is whole of one that was cut off, and names the rest" session.json \
  '(.closed | not) and .keyframes > 3 and (.damage | length) == 1 and .damage[0].what == "cut off"'
refuses "a folder without a session: exit code 1" 1 '^slamd-map: vlp16: holds no session' "$map" info vlp16
refuses "an export of nothing: exit code 2" 2 'says nothing to write' "$map" export vlp16_one/session

# A capture that is cut off in the middle of a record: what came before stays as it was.
mkdir cut && cp vlp16/recording.toml vlp16/imu.csv vlp16/odom.csv cut
head -c $(($(stat -c %s vlp16/lidar.pcap) * 2 / 3 + 11)) vlp16/lidar.pcap >cut/lidar.pcap
check "a capture that is cut off replays" "$replay" --out cut_out cut
holds "and says that it is cut off" cut_out/report.json '.remarks | any(test("ends in the middle of a record"))'
poses=$(($(wc -l <cut_out/odometry.tum) - 1)) # the last scan is cut off itself
check "and gives the poses of the whole one up to there ($poses)" \
  cmp <(head -n "$poses" cut_out/odometry.tum) <(head -n "$poses" vlp16_one/odometry.tum)
check "which are many" test "$poses" -gt 150

# Packets of another sensor in the same capture: the records of one file behind those of the other.
mkdir mixed mixed_avia
cp vlp16/recording.toml vlp16/imu.csv vlp16/odom.csv mixed
{ cat vlp16/lidar.pcap; tail -c +25 avia/lidar.pcap; } >mixed/lidar.pcap
check "a capture with an Avia's packets among the VLP-16's replays" "$replay" --out mixed_out mixed
check "and gives the trajectory of the VLP-16 alone" cmp mixed_out/odometry.tum vlp16_one/odometry.tum
holds "and counts each of them as foreign" mixed_out/report.json \
  ".packets.foreign_port == $(jq '.packets.points + .packets.imu' avia_one/report.json)"
cp avia/recording.toml avia/imu.csv avia/odom.csv mixed_avia
{ cat avia/lidar.pcap; tail -c +25 vlp16/lidar.pcap; } >mixed_avia/lidar.pcap
check "a capture with a VLP-16's packets among the Avia's replays" "$replay" --out mixed_avia_out mixed_avia
check "and gives the trajectory of the Avia alone" cmp mixed_avia_out/odometry.tum avia_one/odometry.tum
holds "and counts each of them as foreign or refused, by reason" mixed_avia_out/report.json \
  "([.packets | to_entries[] | select(.key | test(\"^(refused_|foreign)\")) | .value] | add) ==
   $(jq '.packets.data + .packets.position' vlp16_one/report.json)"

# Exit codes: 1 what cannot be processed, 2 usage (configuration.sh has the rest).
refuses "a recording that is not there: exit code 1" 1 '^slamd-replay: nowhere: does not exist$' "$replay" --out x nowhere
mkdir noise && cp vlp16/recording.toml vlp16/imu.csv vlp16/odom.csv noise && head -c 100000 /dev/urandom >noise/lidar.pcap
refuses "a capture that is none: exit code 1" 1 '^slamd-replay: noise/lidar.pcap: ' "$replay" --out x noise
mkdir unlit && cp vlp16/recording.toml vlp16/lidar.pcap vlp16/odom.csv unlit
refuses "a recording without its imu.csv: exit code 1" 1 '^slamd-replay: unlit/imu.csv: does not exist' "$replay" --out x unlit
echo 'timestamp_ns,gx_rad_s,gy_rad_s' >unlit/imu.csv
refuses "an imu.csv without a column: exit code 1" 1 '^slamd-replay: unlit/imu.csv: .*gz_rad_s' "$replay" --out x unlit
refuses "a file in the output's place: exit code 1" 1 '^slamd-replay: .*avia/imu.csv' "$replay" --out avia/imu.csv avia
refuses "no --out: exit code 2" 2 '--out DIR is required' "$replay" vlp16
refuses "no recording: exit code 2" 2 'RECORDING is required' "$replay" --out x
refuses "an unknown option: exit code 2" 2 '--fast' "$replay" --fast --out x vlp16
refuses "a filter that is none: exit code 2" 2 'kalman' "$replay" --compare kalman --out x vlp16
refuses "a simulation over files that are there: exit code 2" 2 'is not empty' "$bin/slamd-simulate" --out vlp16 --duration 5
check "options may come before and behind the recording" "$replay" --set odometry.seed=1 --out order --set odometry.filter=iekf avia
check "--set chooses the filter" cmp order/odometry.tum avia_one/odometry-iekf.tum
exit "$status"
