#!/usr/bin/env bash
# One test of a rig in the loop, for anyone's CI: starts the simulated devices, examines the rig, captures,
# and compares with a reference. Needs turnlight on the PATH, no root and no hardware.
# Usage: loop_job.sh SIM.yaml RIG.yaml REFERENCE OUT [further words for turnlight compare]
#   REFERENCE  the folder of a run that was found good; its session and result are enough
#   OUT        gets the run, and doctor.xml and compare.xml (JUnit), simulate.log
# Exit code: 0 the same as the reference, 3 different; else that of what failed.
set -euo pipefail
if [ $# -lt 4 ]; then
  sed -n '2,/^# Exit/s/^# //p' "$0" >&2
  exit 2
fi
sim=$1 rig=$2 reference=$3 out=$4
mkdir -p "$out"

turnlight simulate "$sim" >"$out/simulate.log" 2>&1 &
simulator=$!
trap 'kill $simulator 2>/dev/null || true; wait $simulator || true' EXIT
for _ in $(seq 300); do # half a minute at most
  if grep -qs '^ready:' "$out/simulate.log" || ! kill -0 $simulator 2>/dev/null; then break; fi
  sleep 0.1
done
grep '^ready:' "$out/simulate.log" || { cat "$out/simulate.log" >&2 && exit 1; }

turnlight doctor "$rig" --no-move --out "$out" --junit "$out/doctor.xml"
turnlight run "$rig" --out "$out/run"
turnlight compare "$reference" "$out/run" --junit "$out/compare.xml" "${@:5}"
