"""How much of this machine is to be had, and was, while others work on it."""
import multiprocessing
import os
import time

PROBE_SECONDS = 0.3


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


def cpu_seconds_of_all():
    """Since this machine began: of all its processes; 0 where the system does not tell."""
    try:
        with open("/proc/stat", encoding="ascii") as stat:
            user, nice, system, _, _, irq, softirq, steal = map(int, stat.readline().split()[1:9])
    except (OSError, ValueError):
        return 0.0
    return (user + nice + system + irq + softirq + steal) / os.sysconf("SC_CLK_TCK")


def cpu_seconds_of_children():
    """Of those that have ended."""
    times = os.times()
    return times.children_user + times.children_system


def share_had(seconds, of_all, of_children):
    """0.02 to 1: what others left of all cores in that time, in which they all and our children used
    so many CPU seconds."""
    if seconds <= 0:
        return 1.0
    return min(1.0, max(0.02, 1 - (of_all - of_children) / ((os.cpu_count() or 1) * seconds)))
