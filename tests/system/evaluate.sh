#!/usr/bin/env bash
# slamd-evaluate as a person and as a script use it: table, JSON, exit codes, one line for what went wrong.
set -uo pipefail
cd "$(dirname "$0")/../.."
. tests/system/verdicts.bash
needs jq awk

evaluate=$bin/slamd-evaluate
# A circle of 20 m radius, and the same as seen by somebody who stands 3 m aside and whose z creeps up by 0.5 m.
awk 'BEGIN { for (i = 0; i <= 600; ++i) { a = i * 0.0104719755; printf "%.6f %.9f %.9f 0 0 0 %.12f %.12f\n",
  1700000000 + i * 0.1, 20 * sin(a), 20 - 20 * cos(a), sin(a / 2), cos(a / 2) } }' >"$scratch/truth.tum"
awk '{ print $1, $2, $3 + 3, NR * 0.5 / 601, $5, $6, $7, $8 }' "$scratch/truth.tum" >"$scratch/estimate.tum"
awk '{ print $1 }' "$scratch/truth.tum" >"$scratch/times.txt"
awk '{ c = 1 - 2 * $7 * $7; s = 2 * $7 * $8; print c, -s, 0, $2, s, c, 0, $3, 0, 0, 1, $4 }' "$scratch/truth.tum" >"$scratch/rows.txt"
awk '{ $1 = sprintf("%.6f", $1 + 1000); print }' "$scratch/truth.tum" >"$scratch/later.tum"

refuses "no arguments: exit code 2" 2 "REFERENCE is required" "$evaluate"
refuses "one trajectory only: exit code 2" 2 "ESTIMATE is required" "$evaluate" "$scratch/truth.tum"
refuses "an unknown option: exit code 2" 2 "--frobnicate" "$evaluate" --frobnicate "$scratch/truth.tum" "$scratch/truth.tum"
refuses "a unit that is none: exit code 2" 2 "--rpe-unit" "$evaluate" --rpe-unit miles "$scratch/truth.tum" "$scratch/truth.tum"
refuses "a gap that is no number: exit code 2" 2 "--max-gap" "$evaluate" --max-gap soon "$scratch/truth.tum" "$scratch/truth.tum"
refuses "a missing file: exit code 1" 1 "^slamd-evaluate: $scratch/none\.tum: cannot be read$" "$evaluate" "$scratch/truth.tum" "$scratch/none.tum"
refuses "a folder in a file's place: exit code 1" 1 "^slamd-evaluate: $scratch: " "$evaluate" "$scratch/truth.tum" "$scratch"
refuses "trajectories of different days: exit code 1" 1 "have no time in common$" "$evaluate" "$scratch/truth.tum" "$scratch/later.tum"
refuses "KITTI rows without stamps: exit code 1" 1 "give them with --times FILE$" "$evaluate" "$scratch/rows.txt" "$scratch/estimate.tum"
refuses "loops without a session: exit code 2" 2 "SESSION is required" "$evaluate" loops "$scratch/truth.tum"
refuses "loops of what is no session: exit code 1" 1 "holds no session" "$evaluate" loops "$scratch/truth.tum" "$scratch"
echo "1.0 2.0 three" >"$scratch/words.tum"
refuses "words in a trajectory: exit code 1" 1 "^slamd-evaluate: $scratch/words\.tum: line 1: " "$evaluate" "$scratch/truth.tum" "$scratch/words.tum"

"$evaluate" "$scratch/truth.tum" "$scratch/estimate.tum" >"$scratch/table"
for row in "APE, SE\(3\)-aligned" "APE, yaw-aligned" "APE, unaligned" "RPE translation" "RPE rotation" "tilt, yaw-aligned" \
  "KITTI segments" "end drift"; do
  check "the table has a row: $row" grep -qE "^$row" "$scratch/table"
done
"$evaluate" --json "$scratch/truth.tum" "$scratch/estimate.tum" >"$scratch/figures.json"
holds "--json is JSON with all measures" "$scratch/figures.json" \
  '[.pairs, .reference_path_m, .ape_m.se3.rmse, .ape_m.yaw.rmse, .ape_m.none.rmse, .ape_rotation_deg.rmse, .rpe_m.rmse,
    .rpe_deg.rmse, .kitti.translation_percent, .tilt_deg.mean, .end_drift_m, .end_drift_percent] | all(type == "number")'
holds "the measures are those of the made-up error" "$scratch/figures.json" \
  '.pairs == 601 and (.reference_path_m - 125.66 | fabs) < 0.05 and .ape_m.none.min > 2.99 and .ape_m.yaw.max < 0.26 and
   .tilt_deg.max < 0.001 and (.rpe_m.rmse - 0.0398 | fabs) < 0.001'
"$evaluate" --json --evo "$scratch/truth.tum" "$scratch/estimate.tum" >"$scratch/evo.json"
holds "--evo pairs each pose with its own stamp here" "$scratch/evo.json" '.pairs == 601'
"$evaluate" --json --times "$scratch/times.txt" "$scratch/rows.txt" "$scratch/truth.tum" >"$scratch/kitti.json"
holds "KITTI rows with --times are the same trajectory" "$scratch/kitti.json" '.pairs == 601 and .ape_m.none.max < 0.0002'
exit "$status"
