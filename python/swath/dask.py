# SPDX-License-Identifier: GPL-3.0-or-later
"""A run of swath on a Dask cluster: one process for each task.

The list of tasks is made by `swath tasks CONFIG --survey S --output O --parts N --save tasks.json` and lies, like survey, config and output
folder, on a file system that all workers see. Points never pass the scheduler: a task gets its name and returns a few figures.

    from dask.distributed import Client
    import swath.dask
    swath.dask.run("tasks.json", Client("tcp://scheduler:8786"))
"""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any


class TaskFailed(RuntimeError):
    """A task ended with an error; the message is the program's own."""


def do(task: str, tasks: str, program: str, threads: int, *needs: Any) -> dict[str, Any]:
    """Runs one task in a process of its own. `needs`: results of other tasks, for their order alone."""
    start = time.monotonic()
    done = subprocess.run([program, "task", task, "--tasks", tasks, "--threads", str(threads), "--quiet"], capture_output=True, text=True)
    # 3: done, but a limit of quality was missed.
    if done.returncode not in (0, 3):
        said = done.stderr.strip()[-2000:]
        raise TaskFailed(f"task {task} on {socket.gethostname()}: {said or f'exit code {done.returncode}'}")
    return {"id": task, "host": socket.gethostname(), "seconds": round(time.monotonic() - start, 3), "code": done.returncode}


def _wave(*done: Any) -> int:
    """All tasks of a wave are done: the next one waits for this alone."""
    return len(done)


def run(tasks: str | os.PathLike[str], client: Any, program: str = "swath", threads: int = 1, retries: int = 2, memory: str | None = None,
        report: Callable[[int, int], Any] | None = None) -> list[dict[str, Any]]:
    """Does all tasks of the list and returns their figures: id, host, seconds, exit code.

    tasks    file that `swath tasks --save` wrote
    client   dask.distributed.Client
    program  the swath program, as the workers find it
    threads  of each task; a worker should have as many
    retries  of a task that failed; one whose worker died is given to another in any case
    memory   name of a worker resource in bytes ("memory"): a task then runs only where its peak memory is free
    report   function called with (done, total) after each task; without it a line goes to standard error every few seconds

    Raises TaskFailed with the program's own message. The same call goes on where an earlier one stopped.
    """
    from dask.distributed import as_completed  # type: ignore[import-not-found, unused-ignore]

    listed = os.path.abspath(tasks)
    with open(listed, encoding="utf-8") as file:
        every = json.load(file)["tasks"]
    futures: list[Any] = []
    before: tuple[Any, ...] = ()
    wave: list[Any] = []
    number = None
    for task in every:
        if task["wave"] != number:
            before = (client.submit(_wave, *wave, pure=False),) if wave else ()
            wave, number = [], task["wave"]
        needed = {memory: task["memory"]} if memory else None
        future = client.submit(do, task["id"], listed, program, threads, *before, pure=False, retries=retries, resources=needed,
                               key=f"swath-{task['id']}-{os.path.getmtime(listed)}", priority=-task["wave"])
        wave.append(future)
        futures.append(future)
    figures, last = [], time.monotonic()
    for future in as_completed(futures):
        if future.status == "error":
            error = future.exception()
            client.cancel([f for f in futures if not f.done()])
            raise error
        figures.append(future.result())
        if report:
            report(len(figures), len(futures))
        elif time.monotonic() - last > 5 or len(figures) == len(futures):
            last = time.monotonic()
            print(f"swath: {len(figures)} of {len(futures)} tasks", file=sys.stderr, flush=True)
    return figures
