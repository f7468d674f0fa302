"""Runs the script of `couloir sweep --engine hq` on a local HyperQueue.

    python tests/cluster/hyperqueue_local.py SCRIPT SHARDS CORES

PyPI has HyperQueue's library, and no `hq`: this submits what
`hq submit --array=1-SHARDS sh SCRIPT` would. It prints the seconds that
starting the cluster took, which are no cost of an event.
"""

import sys
import time
from pathlib import Path

from hyperqueue import Job, LocalCluster
from hyperqueue.cluster import WorkerConfig


def main():
    script, shards, cores = Path(sys.argv[1]).resolve(), int(sys.argv[2]), int(sys.argv[3])
    begun = time.monotonic()
    with LocalCluster() as cluster:
        cluster.start_worker(WorkerConfig(cores=cores))
        client = cluster.client()
        print(f"started in {time.monotonic() - begun:.2f} s")
        job = Job(default_workdir=script.parent)
        for shard in range(1, shards + 1):
            # Tasks of the library are numbered from 0, whatever one says.
            job.program(["sh", "-c", f"HQ_TASK_ID={shard} exec sh {script.name}"])
        submitted = client.submit(job)
        client.wait_for_jobs([submitted])


if __name__ == "__main__":
    main()
