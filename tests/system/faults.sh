#!/usr/bin/env bash
# Faults: what the command line takes and refuses, and whether a replay counts what was done, reason by reason.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq
seconds=${SLAMD_FAULTS_SECONDS:-20}  # 300: the long form

sim() { "$bin/slamd-simulate" "$@"; }

# A bad value: one line that names the option and the value, exit 2, nothing written.
while IFS='|' read -r option value pattern; do
  refuses "$option '$value' is refused" 2 "$option $value: .*$pattern" sim --out "$scratch/none" "$option=$value"
  refuses "faults $option '$value' is refused" 2 "$option $value: .*$pattern" \
    sim faults "$scratch" "$scratch/none" "$option=$value"
done <<'END'
--drop|120%|is no share between 0 and 100%
--drop|-1%|is no share between 0 and 100%
--garbage|much|is no number
--truncate|1ms|is no share
--burst|3|is not of the form COUNTxPACKETS
--burst|3x50y|is not of the form COUNTxPACKETS
--burst|2.5x50|two whole numbers
--clock-step|2s|is not of the form TIME@MOMENT
--clock-step|2h@3|is no time
--blackout|-2s@3|must lie after the beginning
--blackout|2s@|is not of the form TIME@MOMENT
--imu-gap|0.3s@-1|must lie after the beginning
--imu-offset|8 parsecs|is no time
--imu-clip|1.5|is not of the form RADPS,MPS2
--imu-clip|1.5,15g|is not of the form RADPS,MPS2
--imu-clip|-1,15|must not be negative
--block-fov|160|is not of the form FROM:TO
--block-fov|160:999|degrees from -360 to 360
END
refuses "shares that exceed the whole together are refused" 2 'must not exceed 100% together' \
  sim --out "$scratch/none" --reorder 60% --duplicate 60%
[ ! -e "$scratch/none" ] && pass "a refused command leaves nothing behind" || fail "a refused command leaves nothing behind"

# Everything at once. Moments are shares of the drive, so that the long form spreads them over five minutes.
at() { awk "BEGIN { printf \"%.2f\", $1 * $seconds }"; }
all=(--drop 1% --burst 3x50 --reorder 1% --duplicate 1% --truncate 0.5% --garbage 0.5%
  --clock-step "-0.5s@$(at 0.4)" --clock-step "2s@$(at 0.7)" --blackout "1s@$(at 0.55)" --imu-gap "0.3s@$(at 0.45)"
  --imu-offset 8ms --imu-clip 0.5,11 --block-fov 160:200)
for lidar in vlp16 livox_avia; do
  drive=$scratch/$lidar mapped=$scratch/$lidar.map
  check "$lidar: a drive of $seconds s is simulated with all faults" sim --lidar "$lidar" --seed 7 --duration "$seconds" "${all[@]}" --out "$drive"
  check "$lidar: its replay ends by itself" timeout $((60 + 4 * seconds)) "$bin/slamd-replay" --out "$mapped" "$drive"
  jq -n --slurpfile faults "$drive/faults.json" --slurpfile report "$mapped/report.json" \
    '{faults: $faults[0], report: $report[0]}' >"$scratch/both.json"
  holds "$lidar: every fault is told in faults.json" "$scratch/both.json" \
    '.faults.asked | (.drop, .reorder, .duplicate, .truncate, .garbage, .imu_offset_s, .burst.count) > 0
      and (.clock_steps | length) == 2 and (.blackouts | length) == 1 and (.imu_gaps | length) == 1
      and .imu_clip.rate_radps == 0.5 and .block_fov.from_deg == 160'
  holds "$lidar: what was read is what was written and what was taken away" "$scratch/both.json" \
    '[.faults.packets[] | .read + .duplicated == .written + .blackout + .gap + .burst + .dropped] | all'
  holds "$lidar: report.json counts each reason as the injector did" "$scratch/both.json" \
    '[.report.packets, .faults.report_packets] | map(with_entries(select(.value != 0))) | .[0] == .[1]'
  holds "$lidar: and not a packet more or less" "$scratch/both.json" \
    '([.report.packets[]] | add) == ([.faults.packets[].written] | add)'
  holds "$lidar: inertial rows are as many as were written" "$scratch/both.json" \
    '.report.imu.rows == .faults.imu_rows.written'
  holds "$lidar: each intact point packet became a block, or was refused by reason" "$scratch/both.json" \
    '(.report.blocks | del(.missing) | [.[]] | add) == (.report.packets.data // .report.packets.points)'
  jq -c '{lost: [.faults.packets[] | .blackout + .gap + .burst + .dropped] | add, packets: .report.packets, blocks: .report.blocks, imu: .report.imu}' "$scratch/both.json"
done
exit "$status"
