#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Everything that the apps print and write, to hold one build against another:
#   scripts/parts/every_verb.sh APPS FOLDER [RECORDINGS]
# runs each verb with the apps in APPS, on simulated flights and on the recorded ones in RECORDINGS,
# and leaves what came of it in FOLDER: NAME.out, .err and .exit of each command, and the files that
# it wrote. `diff -r` of two folders says what changed.
set -euo pipefail
apps=$(realpath "$1") folder=$2 recordings=${3:+$(realpath "$3")}
mkdir -p "$folder"
cd "$folder"

# run NAME VERB...: one command of the app, whatever its exit code.
run() {
  local name=$1 app=$2 code=0
  shift 2
  "$apps/sepcal-$app" "$@" >"$name.out" 2>"$name.err" || code=$?
  echo "$code" >"$name.exit"
}

# loop NAME APP FLIGHT EFFECT OPTION...: fit with the options, then every verb that takes a fit.
loop() {
  local name=$1 app=$2 flight=$3 effect=$4
  shift 4
  run "$name-fit" "$app" fit "$flight" "$@" -o "$name.json"
  run "$name-fit-json" "$app" fit "$flight" "$@" --json
  [[ -f $name.json ]] || return 0
  run "$name-compare" "$app" compare "$flight" "$name.json"
  run "$name-compare-json" "$app" compare "$flight" "$name.json" --json
  run "$name-diagnose" "$app" diagnose "$flight" "$name.json" -o "$name.diagnosis.json"
  run "$name-add" "$app" add "$flight" "$name.json" "$effect" -o "$name.next.json"
  run "$name-apply" "$app" apply "$flight" "$name.json" -o "$name.corrected.csv"
  [[ ! -f $name.next.json ]] || run "$name-apply-next" "$app" apply "$flight" "$name.next.json" \
    -o "$name.next.corrected.csv"
}

five_hole=(--k-alpha 4.5 --k-beta 4.5 --lever-arm "0.35,0,-0.02")
run effects-pitot pitot effects
run effects-mag mag effects
run effects-json pitot effects --json

run simulate-five-hole pitot simulate -o five_hole.csv --truth five_hole.truth.json --rate 10 \
  --hide "wind[altitude_m]=0.03:0.01"
run five_hole-check pitot check five_hole.csv "${five_hole[@]}" -o five_hole.check.json
loop five_hole pitot five_hole.csv "wind[altitude_m]" "${five_hole[@]}"
run five_hole-intervals pitot intervals five_hole.csv five_hole.json -o five_hole.intervals.json
run five_hole-inject pitot diagnose five_hole.csv five_hole.json --inject "propwash=40"
loop five_hole_huber pitot five_hole.csv "propwash" "${five_hole[@]}" --loss huber \
  --bounds w_d=-1,1 --fix b_va=0.5 --samples 200 --seed 3

run simulate-tube pitot simulate --probe pitot-static -o tube.csv --rows 400 --noise ar \
  --hide "pressure_offset[throttle]=30" --decoys 3
run tube-check pitot check tube.csv
loop tube pitot tube.csv "pressure_offset[throttle]" --probe pitot-static
run tube-intervals pitot intervals tube.csv tube.json

run simulate-mag mag simulate -o mag.csv --rows 500 --hide "bias[current_a]=0.2:-0.1:0.15"
run mag-check mag check mag.csv
loop mag mag mag.csv "bias[current_a]"
loop mag_strength mag mag.csv "bias[current_a]" --field-strength 53.2
run mag_short-simulate mag simulate -o mag_short.csv --rows 20 --excitation poor
loop mag_short mag mag_short.csv "bias_step"

# What is refused, and in which words.
run refused-file pitot fit nothing.csv
run refused-column mag fit tube.csv
run refused-option pitot fit tube.csv --probe pitot-static --fix nothing=1
run refused-effect pitot fit tube.csv --probe pitot-static --effect "nothing[time]"
run refused-bounds pitot fit tube.csv --probe pitot-static --bounds s_va=2,1
run refused-json pitot compare tube.csv tube.csv
run help-pitot pitot --help
run help-fit pitot fit --help
run help-mag mag fit --help

run aircraft-effects aircraft effects --json
run simulate-aircraft aircraft simulate -o aircraft.csv --geometry aircraft.json --rows 700 --seed 3
run simulate-another aircraft simulate -o another.csv --rows 700 --seed 4
for model in path longitudinal lateral six-dof aero; do
  run "$model-check" aircraft check aircraft.csv --model "$model" --json
  run "$model-fit" aircraft fit aircraft.csv --model "$model" --geometry aircraft.json -o "$model.json"
  run "$model-compare" aircraft compare aircraft.csv "$model.json" --json
  run "$model-another" aircraft compare another.csv "$model.json"
  run "$model-apply" aircraft apply aircraft.csv "$model.json" -o "$model.csv"
done
for model in longitudinal aero; do
  run "$model-diagnose" aircraft diagnose aircraft.csv "$model.json" -o "$model.diagnosis.json"
  run "$model-add" aircraft add aircraft.csv "$model.json" "Cm[alpha^2]" -o "$model.next.json"
  run "$model-intervals" aircraft intervals aircraft.csv "$model.json" --parameter Cm_alpha
done
run two-step aircraft two-step aircraft.csv --geometry aircraft.json -o two.json
run track aircraft track another.csv longitudinal.json -o track.csv
run band-fit aircraft fit aircraft.csv --model aero --geometry aircraft.json --method frequency --json
run response aircraft response aircraft.csv --of q_radps --input elevator_rad --band 1:3 --window 2 -o response.csv
run design aircraft design --input elevator_rad=0.05 --input aileron_rad=0.1 -o inputs.csv

[[ -n $recordings ]] || exit 0
run bench-check mag check "$recordings/bench_tilt_sphere_mag.csv" --field-strength 48
run octocopter-check mag check "$recordings/octocopter_internal_mag.csv" --field 19.72,-1.41,49.44
for log in uav_pitot_static_2022_05_07_11 airliner_mode_s rv_deceleration_stall; do
  run "$log-check" pitot check "$recordings/$log.csv"
done
loop bench mag "$recordings/bench_tilt_sphere_mag.csv" "bias_step" --field-strength 48
loop octocopter_external mag "$recordings/octocopter_external_mag.csv" "bias[current_a]" \
  --field 19.72,-1.41,49.44
loop octocopter_internal mag "$recordings/octocopter_internal_mag.csv" "bias[voltage_v]" \
  --field 19.72,-1.41,49.44
loop uav pitot "$recordings/uav_pitot_static_2022_05_07_11.csv" "time_offset"
loop airliner pitot "$recordings/airliner_mode_s.csv" "wind[spline(time,6)]"
loop stall pitot "$recordings/rv_deceleration_stall.csv" "time_offset"
