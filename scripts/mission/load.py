"""How much of this machine is to be had while others work on it."""
import multiprocessing
import os
import time

PROBE_SECONDS = 1.0  # in 0.3 the same load gave 0.20 to 0.27, in 1.0 0.23 to 0.25


def _cpu_seconds_of_a_moment(_):
    began, end = time.process_time(), time.monotonic() + PROBE_SECONDS
    while time.monotonic() < end:
        pass
    return time.process_time() - began


def share_to_be_had():
    """0.02 to 1: what a program with a thread a core gets now of the time of all cores."""
    cores = os.cpu_count() or 1
    with multiprocessing.get_context("fork").Pool(cores) as pool:
        got = sum(pool.map(_cpu_seconds_of_a_moment, range(cores), chunksize=1))
    return min(1.0, max(0.02, got / (cores * PROBE_SECONDS)))
