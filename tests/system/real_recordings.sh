#!/usr/bin/env bash
# Recordings that the project did not make (../shared/data; skipped where they are absent): another simulator's drives
# and real sensors' packets, against their truth.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq awk
data=$(realpath -m "${SLAMD_SHARED_DATA:-$PWD/../shared/data}")
replay=$bin/slamd-replay

# has WHAT FOLDER: skips visibly when the data are not there.
has() {
  [ -e "$data/$2" ] || { skip "$1: $data/$2 is not there"; return 1; }
}

# ape_of TRUTH ESTIMATE: the SE(3)-aligned error.  Units: m.
ape_of() { "$bin/slamd-evaluate" --json "$1" "$2" | tee "$scratch/ape.json" | jq '.ape_m.se3.rmse'; }

for name in town_vlp16 town_avia indoor_vlp16_dual; do
  has "$name" "recordings/$name" || continue
  check "$name replays" "$replay" --out "$scratch/$name" "$data/recordings/$name"
  ape=$(ape_of "$data/recordings/$name/truth.tum" "$scratch/$name/odometry.tum")
  holds "$name: APE of $ape m is at most 0.03 m" "$scratch/ape.json" '.ape_m.se3.rmse <= 0.03 and .pairs > 100'
  holds "$name: no packet is unexplained, no block refused" "$scratch/$name/report.json" \
    '(.packets | to_entries | all(.value == 0 or (.key | test("^(data|points|imu|position)$")))) and
     (.blocks | to_entries | all(.value == 0 or .key == "accepted")) and .scans_dropped == 0'
  # The last scan may be a sliver, and then says which direction it does not see.
  holds "$name: tracks to its end" "$scratch/$name/report.json" \
    '.states.TRACKING.scans >= .scans - 1 and (.state == "TRACKING" or .state == "DEGRADED")'
done

if has "einride" velodyne_packets/einride/recording.pcap; then
  printf '[[lidar]]\nmodel = "vlp16"\n' >"$scratch/vlp16.toml"
  check "einride: 1,000 packets of a real VLP-16 at rest replay, LiDAR only" \
    "$replay" --out "$scratch/einride" --config "$scratch/vlp16.toml" "$data/velodyne_packets/einride/recording.pcap"
  holds "einride: 1,000 packets are taken, in 13 revolutions and two parts" "$scratch/einride/report.json" \
    '.packets.data == 1000 and .blocks.accepted == 1000 and .scans + .scans_before_start == 15 and .states.TRACKING.scans >= 13'
  read -r moved_m turned_deg < <(awk 'END { printf "%.4f %.3f\n", sqrt($2 * $2 + $3 * $3 + $4 * $4),
    2 * atan2(sqrt($5 * $5 + $6 * $6 + $7 * $7), sqrt($8 * $8)) * 57.29578 }' "$scratch/einride/odometry.tum")
  check "einride: ends within 2 cm and 0.2 deg of its start ($moved_m m, $turned_deg deg)" \
    awk "BEGIN { exit !($moved_m <= 0.02 && $turned_deg <= 0.2) }"
fi

if has "kitti" kitti_raw_0005_r16; then
  kitti=$data/kitti_raw_0005_r16
  check "kitti: 73 scans of a street are imported" \
    "$bin/slamd-import" --compensated --truth "$kitti/poses_reference.txt" "$kitti" "$scratch/kitti"
  check "kitti: they replay, LiDAR only" "$replay" --out "$scratch/kitti_out" "$scratch/kitti"
  ape=$(ape_of "$scratch/kitti/truth.tum" "$scratch/kitti_out/odometry.tum")
  holds "kitti: APE of $ape m is at most 0.08 m" "$scratch/ape.json" '.ape_m.se3.rmse <= 0.08 and .pairs == 73'
fi
exit "$status"
