#!/usr/bin/env bash
# Proves: this tree's includes and links go down only, and scripts/check-layers would say so if one did
# not. Does not prove: that the table in scripts/check-layers is the right one.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
check=$root/scripts/check-layers
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{base/plot,calib,rig/session,rig/sim,app} \
  "$tree"/estimator/{model,target,solve,pictures,results,from_session}

# A file's content must be refused, and the message must hold the words.
refused() {
  local file=$1 content=$2 words=$3 said
  printf '%s\n' "$content" >"$tree/$file"
  if said=$("$check" "$tree"); then
    echo "not refused: $file: $content" && exit 1
  fi
  grep -qF "$words" <<<"$said" || { echo "'$words' is not in: $said" && exit 1; }
  rm "$tree/$file"
}
accepted() {
  local file=$1 content=$2
  printf '%s\n' "$content" >"$tree/$file"
  "$check" "$tree" >"$tree/said" || { cat "$tree/said" && exit 1; }
  rm "$tree/$file"
}

"$check" "$root"
accepted base/a.h '#include <vector>'
accepted estimator/target/a.cpp $'#include "calib/pose.h"\n#include <embree3/rtcore.h>'
accepted rig/sim/a.cpp $'#include "estimator/model/scene.h"\n#include "rig/session/session.h"'
accepted estimator/from_session/a.cpp $'#include "rig/session/session.h"\n#include "estimator/estimate.h"'
accepted estimator/pictures/a.cpp $'#include "estimator/estimate.h"\n#include "base/plot/chart.h"'
accepted calib/CMakeLists.txt 'turnlight_layer(tl_calib SOURCES a.cpp USES tl_base mrcal::mrcal)'
refused base/a.h '#include "calib/pose.h"' 'base/a.h:1: calib/pose.h: base may not use calib'
refused estimator/a.cpp $'\n#include "rig/session/session.h"' 'estimator/a.cpp:2:'
refused rig/session/a.cpp '#include "estimator/model/scene.h"' 'rig may not use estimator/model'
refused rig/sim/a.cpp '#include "estimator/estimate.h"' 'rig/sim may not use estimator'
refused base/plot/a.h '#include "estimator/estimate.h"' 'base/plot may not use estimator'
refused estimator/model/a.h '#include "estimator/solve/solver.h"' \
  'estimator/model may not use estimator/solve'
refused estimator/a.cpp '#include "estimator/baseline/paper_estimate.h"' \
  'estimator may not use estimator/baseline'
refused estimator/pictures/a.cpp '#include "estimator/observe/observations.h"' \
  'estimator/pictures may not use estimator/observe'
refused estimator/results/a.cpp '#include "rig/session/session.h"' \
  'estimator/results may not use rig'
refused estimator/from_session/a.cpp '#include "rig/sim/studio.h"' \
  'estimator/from_session may not use rig/sim'
refused estimator/results/CMakeLists.txt \
  'turnlight_layer(tl_results SOURCES a.cpp USES tl_estimator tl_rig)' \
  'estimator/results may not use rig'
refused rig/session/a.cpp '#include "rig/sim/blob.h"' 'rig may not use rig/sim'
refused estimator/a.h '#include "scene.h"' 'written from the top'
refused estimator/solve/a.h 'namespace turnlight::estimator::model {' \
  'allowed is namespace turnlight::estimator::solve'
refused base/a.h 'namespace turnlight::calib {' 'allowed is namespace turnlight'
refused base/a.h '#include <opencv2/core.hpp>' 'base may not use OpenCV'
refused base/a.h '#include <boost/any.hpp>' 'is of no library'
refused calib/CMakeLists.txt 'turnlight_layer(tl_calib SOURCES a.cpp USES tl_base tl_rig)' \
  'calib may not use rig'
refused calib/CMakeLists.txt 'turnlight_layer(tl_calib SOURCES a.cpp USES embree)' \
  'calib may not use Embree'
