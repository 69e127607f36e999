"""The most memory that an audit of a fleet takes while it writes tables, by fleet size.

memory.py SELFNEG FLEET OUT SIZE...: audits the first so many traces of FLEET, for each SIZE;
the peak of the last may be at most 16 MiB above that of the first.
"""

import os
import pathlib
import resource
import shutil
import subprocess
import sys
import time

ALLOWED_KIB = 16 * 1024


def peak(selfneg, fleet, out, size):
    """In a process of its own, since the peak of children is the largest of all so far."""
    some = out / "some"
    shutil.rmtree(some, ignore_errors=True)
    some.mkdir(parents=True)
    traces = sorted(fleet.glob("*.mcap"))
    for number in range(size):
        # More than there are: the same ones again.
        os.link(traces[number % len(traces)], some / f"{number:06}.mcap")
    command = [selfneg, "audit", some, "--robot-key", fleet / "robot.pub", "--identity", fleet / "auditor.key",
               "--parquet", out / "tables"]
    child = os.fork()
    if child == 0:
        began = time.monotonic()
        code = subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        took = time.monotonic() - began
        print(f"{size:6} traces: at most {used.ru_maxrss / 1024:.1f} MiB, {took:.1f} s,"
              f" {used.ru_utime + used.ru_stime:.1f} s of processor time", flush=True)
        (out / "peak").write_text(str(used.ru_maxrss))
        os._exit(0 if code in (0, 1) else 1)
    if os.waitpid(child, 0)[1] != 0:
        sys.exit("FAILED: the audit")
    return int((out / "peak").read_text())


def main():
    selfneg, fleet, out, *sizes = sys.argv[1:]
    peaks = [peak(pathlib.Path(selfneg).resolve(), pathlib.Path(fleet), pathlib.Path(out), int(size))
             for size in sizes]
    if peaks[-1] > peaks[0] + ALLOWED_KIB:
        sys.exit("FAILED: memory grows with the number of traces")


main()
