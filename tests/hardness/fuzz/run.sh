#!/usr/bin/env bash
# Each parser under libFuzzer for some seconds, from the corpus of the tests:
#
#     tests/hardness/fuzz/run.sh [SECONDS] [TARGET...]
#
# It needs a C++ compiler, which builds libFuzzer; the stable toolchain does.
# What fails is left in target/fuzz/found.
set -euo pipefail
cd "$(dirname "$0")"
# With the rest of what is built, which git ignores.
export CARGO_TARGET_DIR=../../../target/fuzz

seconds=${1:-60}
shift || true
corpus=../corpus
if [ $# -eq 0 ]; then
    mapfile -t targets < <(ls "$corpus")
else
    targets=("$@")
fi

# Which branches are taken is told at every edge. With a named target, scripts
# and macros that only build are left as they are.
host=$(rustc -vV | sed -n 's/^host: //p')
RUSTFLAGS="--cfg fuzzing -Cpasses=sancov-module \
-Cllvm-args=-sanitizer-coverage-level=4 \
-Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
-Cllvm-args=-sanitizer-coverage-pc-table \
-Cllvm-args=-sanitizer-coverage-trace-compares \
-Cdebug-assertions -Ccodegen-units=1" \
    cargo build --release --quiet --target "$host"
program=$CARGO_TARGET_DIR/$host/release/couloir-fuzz

found=$CARGO_TARGET_DIR/found
mkdir -p "$found"
failed=0
for target in "${targets[@]}"; do
    learned=$(mktemp -d)
    if COULOIR_TARGET=$target "$program" \
        "$learned" "$corpus/$target" -max_total_time="$seconds" -timeout=2 \
        -rss_limit_mb=2048 -malloc_limit_mb=256 -max_len=20000 \
        -artifact_prefix="$found/$target-" \
        -print_final_stats=1 -verbosity=1 > "$learned.log" 2>&1; then
        result=passed
    else
        result=FAILED
        failed=1
    fi
    of() { grep -o "stat::$1: *[0-9]*" "$learned.log" | grep -o '[0-9]*$'; }
    edges=$(grep -o 'cov: [0-9]*' "$learned.log" | tail -n 1)
    printf '%-10s %s inputs=%s new=%s %s MB=%s\n' "$target" "$result" \
        "$(of number_of_executed_units)" "$(of new_units_added)" \
        "$edges" "$(of peak_rss_mb)"
    rm -rf "$learned" "$learned.log"
done
exit $failed
