#!/usr/bin/env bash
# A disk that is full at every write: each command that writes results does so
# onto a small tmpfs with less and less room, over an earlier run's results.
# Afterwards the folder holds the old results, whole, or the new ones, whole;
# where it is the old ones, the command says why and ends with an exit code
# that is not 0; and nothing temporary is left.
#
#     tests/hardness/full_disk.sh [PATH OF couloir]
#
# Needs root, or `unshare` for users (it takes that by itself), and Linux.
set -euo pipefail

couloir=$(realpath "${1:-target/release/couloir}")
here=$(cd "$(dirname "$0")" && pwd)
if [ -z "${COULOIR_MAY_MOUNT:-}" ]; then
    COULOIR_MAY_MOUNT=yes exec unshare --mount --map-root-user "$0" "$couloir"
fi

work=$(mktemp -d)
disk=$work/disk
mkdir "$disk"
trap 'umount "$disk" 2> /dev/null || true; rm -rf "$work"' EXIT

event=$work/event
mkdir "$event"
cp "$here/corpus/event/plain.toml" "$event/event.toml"
cp "$here/corpus/track/plain.csv" "$event/track.csv"
cp "$here/corpus/recording/plain.csv" "$event/recording.csv"
log=$here/corpus/log/metres.csv

# Runs a command into $disk/out; $1 is its name, $2 a seed.
run() {
    local out=$disk/out
    case $1 in
        calibrate) "$couloir" -q calibrate --quick --seed "$2" --format latex \
            --figures --out "$out" "$event" ;;
        diagnose) "$couloir" -q diagnose --quick --seed "$2" --out "$out" \
            "$event" ;;
        compare) "$couloir" -q compare --draws 200 --seed "$2" --out "$out" \
            --model "voellmy, iid" --model "coulomb, iid" "$event" ;;
        simulate) "$couloir" -q simulate --set "mu=0.2$2" --out "$out" \
            "$event" ;;
        import) "$couloir" -q import --smooth "2$2" --out "$out" "$log" ;;
        sweep) "$couloir" -q sweep --verb calibrate --out "$out" "$event" \
            -- --quick --seed="$2" ;;
        population) "$couloir" -q population --seed "$2" --out "$out" \
            "$work/swept" ;;
        challenge) "$couloir" -q challenge --quick --cases 1 --seed "$2" \
            --out "$out" ;;
        reproduce) "$couloir" -q reproduce --samples 1 --seed "$2" \
            --out "$out" ;;
    esac
}

# Every file below the results with its checksum. What takes time, the
# journals of a sweep, which only ever grow, and what a run is gone on from are
# looked at elsewhere.
sums() {
    (cd "$disk/out" && find . -type f ! -path './results/*' \
        ! -name .couloir-checkpoint -print0 \
        | sort -z | xargs -0 --no-run-if-empty sha256sum)
}

# One run with so many KiB of room over what the old results take.
once() {
    local command=$1 room=$2 code=0
    mount -t tmpfs -o size=64m tmpfs "$disk"
    run "$command" 1 > /dev/null 2>&1
    cp -r "$disk/out" "$work/old"
    sums > "$work/before"
    # What is left is filled, but for the room.
    local free
    free=$(df --output=avail -k "$disk" | tail -1)
    head -c $(((free - room) * 1024)) /dev/zero > "$disk/filler"
    run "$command" 2 > "$work/said" 2>&1 || code=$?
    sums > "$work/after"
    judge "$command" "$room" "$code"
    umount "$disk"
    rm -rf "$work/old"
}

judge() {
    local command=$1 room=$2 code=$3 left
    left=$(find "$disk" -name '.*.tmp' | wc -l)
    if [ "$left" != 0 ]; then
        fail "$command, $room KiB: $left temporary files are left"
    fi
    if cmp --silent "$work/before" "$work/after"; then
        if [ "$code" = 0 ]; then
            fail "$command, $room KiB: nothing written, and exit code 0"
        fi
        grep -qi 'no space left' "$work/said" \
            || fail "$command, $room KiB: $(tail -1 "$work/said")"
        old=$((old + 1))
    elif (cd "$disk/out" && grep -v '^#' couloir.sha256 \
        | sha256sum --check --quiet > /dev/null 2>&1); then
        new=$((new + 1))
        [ "$code" = 0 ] || behind=$((behind + 1))
    else
        fail "$command, $room KiB: results of two runs, exit code $code"
    fi
}

failed=0
fail() {
    echo "FAILED: $*"
    failed=$((failed + 1))
}

# Five posteriors for a population, of one event by five seeds.
printf 'event,seed\nevent,1\nevent,2\nevent,3\nevent,4\nevent,5\n' \
    > "$work/list.csv"
"$couloir" -q sweep --verb calibrate --out "$work/swept" "$work/list.csv" \
    -- --quick > /dev/null

# How many KiB are left, and the same for what takes seconds each time.
rooms="0 4 8 12 16 20 24 28 32 40 48 56 64 80 96 112 128 160 192 224 256 320 \
    384 448 512 640 768 896 1024 1536 2048 4096"
few="0 4 16 32 64 128 512 4096"
for command in ${COULOIR_COMMANDS:-calibrate diagnose compare simulate import \
    sweep population challenge reproduce}; do
    old=0 new=0 behind=0
    these=$rooms
    case $command in challenge | reproduce) these=$few ;; esac
    for room in $these; do
        once "$command" "$room"
    done
    echo "$command: $((old + new)) disks; the old results are whole on $old," \
        "the new ones on $new (of these $behind with an error)"
done
[ "$failed" = 0 ]
