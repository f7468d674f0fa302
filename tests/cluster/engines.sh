#!/usr/bin/env bash
# The same events by this machine's cores, HyperQueue, Slurm and Dask: the
# summaries have to be the same, byte for byte. Prints the time of each.
#
#     cargo build --release
#     cargo run --release --example 18_survey -- SURVEY 100 5
#     sudo tests/cluster/engines.sh target/release/couloir SURVEY
#
# For a Debian machine that may be changed: Slurm comes from Debian's packages
# (slurm-wlm, munge) and is set up as a cluster of this one node, which needs
# root; HyperQueue and Dask come from PyPI into a fresh environment.
set -euo pipefail

couloir=$(realpath "$1")
survey=$(realpath "$2")
root=$(realpath "$(dirname "$0")/../..")
out=$(mktemp -d)
cores=$(nproc)
events=$(($(wc -l < "$survey/list.csv") - 1))
options=(--quick --draws=500 --warmup=500)
sweep=("$couloir" sweep "$survey/list.csv" --quiet --verb=calibrate)
# As many for each core, with at least 100 events each.
shards=$((events / 100 / cores * cores))

journals_of() { find "$out/$1/results" -name "*.jsonl" | wc -l; }

# What a way took in seconds, of its folder's name and its command.
timed() {
    local name=$1 begun ended
    shift
    begun=$(date +%s.%N)
    "$@" > "$out/$name.log" 2>&1 || { cat "$out/$name.log"; exit 1; }
    ended=$(date +%s.%N)
    local journals
    journals=$(journals_of "$name")
    "${sweep[@]}" --out "$out/$name" -- "${options[@]}" > "$out/$name.table"
    head -1 "$out/$name.table"
    # The summary does nothing again: the build is the same everywhere.
    [ "$(journals_of "$name")" = "$journals" ] || { echo "done again"; exit 1; }
    cmp "$out/cores/sweep.json" "$out/$name/sweep.json"
    awk -v name="$name" -v a="$begun" -v b="$ended" -v n="$events" \
        'BEGIN { printf "%s: %.1f s, %.1f ms an event\n", name, b - a, (b - a) / n * 1e3 }'
}

by_cores() { "${sweep[@]}" --out "$out/cores" -- "${options[@]}"; }

start_hyperqueue() {
    python3 -m venv "$out/venv"
    "$out/venv/bin/pip" install --quiet hyperqueue==0.27.0
}

by_hyperqueue() {
    # Without hq the script is written, and not submitted.
    "${sweep[@]}" --out "$out/hq" --engine hq --shards "$shards" --jobs 1 -- "${options[@]}" \
        || test -f "$out/hq/engine/sweep.sh"
    "$out/venv/bin/python" "$root/tests/cluster/hyperqueue_local.py" \
        "$out/hq/engine/sweep.sh" "$shards" "$cores"
}

start_slurm() {
    DEBIAN_FRONTEND=noninteractive apt-get install --yes --quiet \
        --no-install-recommends slurmd slurmctld slurm-client munge \
        > "$out/apt.log" 2>&1
    local host
    host=$(hostname -s)
    mkdir -p /etc/slurm /var/lib/slurm/{slurmd,slurmctld} /run/munge
    cat > /etc/slurm/slurm.conf <<CONF
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdSpoolDir=/var/lib/slurm/slurmd
StateSaveLocation=/var/lib/slurm/slurmctld
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cores State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES State=UP
CONF
    chown munge: /run/munge
    pgrep munged > /dev/null || runuser -u munge -- munged
    # What ran before this script is left running after it.
    pgrep slurmctld > /dev/null || { slurmctld; started+=(slurmctld); }
    pgrep slurmd > /dev/null || { slurmd; started+=(slurmd); }
    sleep 3
    scontrol update nodename="$host" state=resume > /dev/null 2>&1 || true
    sinfo
}

by_slurm() {
    "${sweep[@]}" --out "$out/slurm" --engine slurm --shards "$shards" --jobs 1 -- "${options[@]}"
    while [ -n "$(squeue --noheader)" ]; do sleep 0.2; done
}

start_dask() {
    "$out/venv/bin/pip" install --quiet distributed==2026.8.0 "$root/python"
    "$couloir" --version
    "$out/venv/bin/couloir" --version
}

by_dask() {
    # In a file, which its workers read too.
    cat > "$out/by_dask.py" <<PYTHON
import couloir
from dask.distributed import Client, LocalCluster

if __name__ == "__main__":
    with LocalCluster(n_workers=$cores, threads_per_worker=1,
                      dashboard_address=None) as cluster:
        couloir.sweep("$survey/list.csv", "$out/dask", verb="calibrate",
                      client=Client(cluster), shards=$shards, quick=True,
                      draws=500, warmup=500)
PYTHON
    "$out/venv/bin/python" "$out/by_dask.py"
}

started=()
finish() {
    for daemon in "${started[@]}"; do pkill "$daemon" || true; done
    rm -rf "$out"
}
trap finish EXIT

echo "$events events, $cores cores, $shards shards"
timed cores by_cores
start_hyperqueue
timed hq by_hyperqueue
start_slurm
timed slurm by_slurm
start_dask
timed dask by_dask
