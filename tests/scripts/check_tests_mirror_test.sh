#!/usr/bin/env bash
# Proves: every source of this tree has a test of its name or a README that says which test covers it,
# and scripts/check-tests-mirror would say so if one had not. Does not prove: that the test covers it.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
check=$root/scripts/check-tests-mirror
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

refused() {
  local words=$1 said
  if said=$("$check" "$tree"); then
    echo "not refused: $words" && exit 1
  fi
  grep -qF "$words" <<<"$said" || { echo "'$words' is not in: $said" && exit 1; }
}
readme() { printf '| sources | covered by |\n|---|---|\n%s\n' "$1" >"$tree/base/README.md"; }

"$check" "$root"
refused '0 sources'
mkdir -p "$tree"/{base/plot,tests/base}
touch "$tree"/base/{a,b}.cpp "$tree"/base/plot/c.cpp "$tree"/tests/base/a_test.cpp
refused 'base/b.cpp: there is no tests/base/b_test.cpp'
readme '| `b`, `plot/c` | `tests/base/a_test.cpp` |'
"$check" "$tree" >/dev/null || { "$check" "$tree"; exit 1; }
readme '| `b` | `tests/base/a_test.cpp` |'
refused 'base/plot/c.cpp: there is no tests/base/plot/c_test.cpp'
readme '| `b`, `plot/c` | `tests/base/no_test.cpp` |'
refused 'base/README.md:3: there is no test tests/base/no_test.cpp'
readme '| `b`, `plot/c`, `d` | `tests/base/a_test.cpp` |'
refused 'there is no source base/d.cpp'
readme '| `a`, `b`, `plot/c` | `tests/base/a_test.cpp` |'
refused 'a has a test of its name and needs no row'
readme '| `b`, `plot/c` | the others |'
refused 'names sources and tests in backticks'
printf '`b` and `plot/c` are covered by `tests/base/a_test.cpp`.\n' >"$tree/base/README.md"
refused 'base/b.cpp: there is no'
