"""sweep_kills.py MISSION OUTPUT KILLS SEED COMMAND...: for sweep_kills.sh

COMMAND runs the mission. It is run undisturbed, its results go to OUTPUT/undisturbed; then again and
again from nothing, each time killed with all its processes and started anew until it ends.
"""
import collections
import ctypes
import hashlib
import json
import os
import random
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import time

import dives

PR_SET_CHILD_SUBREAPER = 36
SHARE_OF_TIME = 1 / 2  # of the undisturbed run's, within which a kill comes: it has to get on between two
# Files that tell of the run itself, not of the dive.
OF_THE_RUN = ("log.txt", "engine.txt", "lock")
# In others, what tells of the run: its times and its memory; in records of stages also the sums of
# files that hold such, which are compared themselves.
TIMES_IN_JSON = re.compile(rb'"(\w*seconds|peak_rss_bytes|ended)": ?[-+.\de]+')
SUMS_IN_JSON = re.compile(rb'"(size|hash)": ?("[^"]*"|\d+)')
TIMES = re.compile(rb"[-:\d]+ \d+:\d+|\d[.\d]* (s|min|h)\b")
# A log of COLMAP's has times in its tables, and addresses.
FIGURES = re.compile(rb"\s*(0x[\da-f]+|[-+.\d]*\d[-+.\de]*)")
SECONDS_OF_PAIRS = slice(11, 14)  # columns of pairs.csv


def descendants():
    """Of this process, of which every orphan below it becomes a child."""
    parents = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as stat:
                parents[int(name)] = int(stat.read().rpartition(")")[2].split()[1])
        except OSError:
            continue  # it has ended
    found = {os.getpid()}
    while more := {child for child, parent in parents.items() if parent in found} - found:
        found |= more
    return found - {os.getpid()}


def signal_all(number, processes):
    for process in processes:
        try:
            os.kill(process, number)
        except ProcessLookupError:
            pass


def kill_tree():
    """As a power cut: all at once, so that no process sees another one die."""
    stopped = set()
    while more := descendants() - stopped:
        signal_all(signal.SIGSTOP, more)
        stopped |= more
    signal_all(signal.SIGKILL, stopped)
    try:
        while True:
            os.waitpid(-1, 0)
    except ChildProcessError:
        pass


def run(command, log, seconds=None):
    """Its exit code; None where it was killed after so many seconds."""
    with open(log, "ab") as file:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=file)
        try:
            return process.wait(seconds)
        except subprocess.TimeoutExpired:
            kill_tree()
            return None


def rows(path):
    database = sqlite3.connect(path)
    try:
        if database.execute("PRAGMA integrity_check").fetchone()[0] != "ok":
            return "damaged"
        dump = hashlib.blake2b()
        for line in database.iterdump():
            dump.update(line.encode("utf-8", "surrogateescape"))
        return dump.hexdigest()
    finally:
        database.close()


def without_seconds(table):
    rows_of = [line.split(b",") for line in table.splitlines()]
    for row in rows_of:
        del row[SECONDS_OF_PAIRS]
    return b"\n".join(b",".join(row) for row in rows_of)


def content(path):
    """What must be the same in every run."""
    name, ending = os.path.basename(path), os.path.splitext(path)[1]
    if ending == ".db":
        return rows(path)
    with open(path, "rb") as file:
        data = file.read()
    if ending in (".json", ".html"):
        data = TIMES_IN_JSON.sub(b"", data)
    if name in ("summary.txt", "mission.html"):
        data = TIMES.sub(b"", data)
    if os.path.basename(os.path.dirname(path)) == "state":
        data = SUMS_IN_JSON.sub(b"", data)
    if ending == ".log":
        data = FIGURES.sub(b"", data)
    if name == "pairs.csv":
        data = without_seconds(data)
    return hashlib.blake2b(data).hexdigest()


def contents(results):
    """Of each file that a mission left, by its path."""
    found = {}
    for root, folders, files in os.walk(results):
        folders[:] = [name for name in folders if name != ".snakemake"]
        for name in files:
            path = os.path.relpath(os.path.join(root, name), results)
            if name not in OF_THE_RUN and path != "estimate.json":
                found[path] = content(os.path.join(root, name))
    return found


def stamp(path):
    status = os.stat(path)
    return status.st_ino, status.st_mtime_ns


def finished(results):
    """What is done for good, and when: stages of the dives' workspaces, and dives that came out."""
    found = {}
    for root, _, files in os.walk(results):
        for name in files:
            path = os.path.join(root, name)
            is_stage = os.path.basename(root) == "state" and name.endswith(".json")
            is_dive = name == dives.RECORDS["full"] and not dives.has_failed(dives.read_json(path))
            if is_stage or is_dive:
                found[os.path.relpath(path, results)] = stamp(path)
    return found


class Sweep:
    def __init__(self, mission, output, command):
        self.results = os.path.join(mission, dives.RESULTS)
        self.output, self.command = output, command
        self.num_faults = 0
        self.hit = collections.Counter()

    def fault(self, text):
        self.num_faults += 1
        print(f"  {text}", flush=True)

    def run(self, seconds=None):
        return run(self.command, os.path.join(self.output, "log.txt"), seconds)

    def undisturbed(self):
        """Sets what to compare with."""
        shutil.rmtree(self.results, ignore_errors=True)
        began = time.monotonic()
        self.exit_code = self.run()
        self.seconds = time.monotonic() - began
        self.contents = contents(self.results)
        kept = os.path.join(self.output, "undisturbed")
        shutil.rmtree(kept, ignore_errors=True)
        shutil.copytree(self.results, kept, symlinks=True)

    def killed_until_it_ends(self, max_kills):
        """From nothing, at most so many kills; returns how many there were."""
        shutil.rmtree(self.results, ignore_errors=True)
        num_kills, done = 0, {}
        while True:
            is_last = num_kills == max_kills
            moment = random.uniform(0, SHARE_OF_TIME * self.seconds)
            exit_code = self.run(None if is_last else moment)
            now = finished(self.results)
            for path in sorted(done.items() - now.items()):
                self.fault(f"{path[0]}: done before a kill, and once more after it")
            done = now
            if exit_code is not None:
                break
            num_kills += 1
            self.hit[self.at_work()] += 1
        self.compare(exit_code)
        return num_kills

    def at_work(self):
        """The dive that was, by the mission's log; "none" before, between and after them."""
        line = (dives.last_line(os.path.join(self.results, "log.txt")) or [""])[-1]
        begun = re.fullmatch(r"\S+ \S+ (.*): (full|coarse) begun", line)
        return begun[1] if begun else "none"

    def compare(self, exit_code):
        if exit_code != self.exit_code:
            self.fault(f"exit code {exit_code}, undisturbed {self.exit_code}")
        found = contents(self.results)
        for path in sorted(found.keys() | self.contents.keys()):
            if path not in found or path not in self.contents:
                self.fault(f"{path}: " + ("only undisturbed" if path in self.contents else "left over"))
            elif found[path] != self.contents[path]:
                self.fault(f"{path}: differs")


def main(mission, output, kills, seed, *command):
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    random.seed(int(seed))
    sweep = Sweep(mission, output, command)
    sweep.undisturbed()
    print(f"undisturbed: exit code {sweep.exit_code}, {sweep.seconds:.0f} s, "
          f"{len(sweep.contents)} files", flush=True)
    num_kills = num_runs = 0
    while num_kills < int(kills):
        num_kills += sweep.killed_until_it_ends(int(kills) - num_kills)
        num_runs += 1
        print(f"{num_runs} missions, {num_kills} kills, {sweep.num_faults} faults", flush=True)
    print("kills by the dive that was at work: " +
          ", ".join(f"{dive} {count}" for dive, count in sorted(sweep.hit.items())))
    return 1 if sweep.num_faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
