"""Independent jobs, many at once: on the processes of this machine, or on a Dask cluster.

What is worked on is a function that is found by its name and a list of jobs, each plain data. A worker that
dies takes nothing with it: its jobs are done again elsewhere. What comes back does not depend on where it was
made, only its order does.
"""

from __future__ import annotations

from gmr.cluster.running import LOCAL, results, worker_count

__all__ = ["LOCAL", "results", "worker_count"]
