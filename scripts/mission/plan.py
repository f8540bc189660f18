"""What a mission will take, and in which order its dives are run.

plan.py deadline --hours|--deadline VALUE    the deadline, as deadline.py writes it
plan.py tell MISSION BINARY QUALITY DEADLINE    what it will take, into the mission's log
plan.py must_stop DEADLINE    exits with 0 when it is over
"""
import json
import os
import statistics
import subprocess
import sys

import deadline as deadlines
import dives
import load

# Of a coarse step, on Debian 12 with two cores of 2.3 GHz that nobody else uses: to begin with, and
# of each picture.
COARSE_SECONDS = 4.0
COARSE_SECONDS_OF_PICTURE = 0.2
FULL_SECONDS = 1.0  # of any step, to begin with
MAX_HISTORY = 20  # of each step


def cache_path(name):
    cache = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return os.path.join(cache, "colmap_seapoint", name)


def read_history(step):
    """How much longer than expected that step took in this machine's missions, had nobody else used
    it; the newest last."""
    known = dives.read_json(cache_path("missions.json"))
    ratios = known.get(step) if isinstance(known, dict) else None
    return [one for one in ratios or [] if isinstance(one, (int, float)) and 0.01 < one < 100]


def remember(step, seconds, share, estimated):
    """That a step took so long while that share of the machine was to be had (load.py); a convenience,
    done without where it fails."""
    if not estimated:
        return
    known = {one: read_history(one) for one in dives.RECORDS}
    ratio = seconds * share / expected_seconds(step, estimated)
    known[step] = (known[step] + [round(ratio, 4)])[-MAX_HISTORY:]
    try:
        dives.write_whole(cache_path("missions.json"), json.dumps(known))
    except OSError:
        pass


def command_of(mission, dive, binary, quality):
    """automatic_reconstructor on the dive as it is."""
    command = [binary, "automatic_reconstructor", "--image_path", dives.image_path(mission, dive),
               "--workspace_path", dives.result_path(mission, dive, dives.WORKSPACES["full"]),
               "--quality", quality]
    project = dives.project_path(mission, dive)
    return command + (["--project_path", project] if project else [])


def estimate(mission, dive, binary, quality):
    """What the program says that a dive takes: a dict with seconds, pictures, disk_bytes ...; None
    where it cannot be read. Asked once for the same files, quality and program."""
    path = dives.result_path(mission, dive, "estimate.json")
    key = [dives.digest(mission, dive), quality, dives.checksum(binary)]
    known = dives.read_json(path) or {}
    if known.get("key") == key:
        return known["estimate"]
    # Without what the program has learnt from its own runs: that counts the load of their time, and
    # what missions have learnt does not.
    asked = subprocess.run(command_of(mission, dive, binary, quality) + ["--estimate_only", "1"],
                           stdin=subprocess.DEVNULL, capture_output=True, check=False,
                           env=dict(os.environ, XDG_CACHE_HOME=cache_path("of_no_run")))
    try:
        found = json.loads(asked.stdout) if asked.returncode == 0 else None
    except ValueError:
        found = None
    dives.write_whole(path, json.dumps({"key": key, "estimate": found}) + "\n")
    return found


def expected_seconds(step, estimated):
    """Of a step, by the estimate of its dive, on the machine that the constants were measured on."""
    if step == "full":
        return FULL_SECONDS + estimated["seconds"]
    return (COARSE_SECONDS + estimated["intake_seconds"] +
            COARSE_SECONDS_OF_PICTURE * estimated["pictures"])


def seconds_of(step, estimated):
    """On this machine where nobody else uses it; of a dive that cannot be read those that it takes to
    find that out."""
    if not estimated:
        return FULL_SECONDS
    return expected_seconds(step, estimated) * statistics.median(read_history(step) + [1.0])


def order(mission, step, binary, quality):
    """The dives that need the step, the shortest first: by a deadline most dives are done."""
    wanted = []
    for dive in dives.dives(mission):
        result = dives.outcome(mission, dive)
        if step == "coarse" and dives.is_current(result, dives.digest(mission, dive), quality,
                                                 dives.checksum(binary)):
            continue  # more than that is there
        wanted.append((seconds_of(step, estimate(mission, dive, binary, quality)), dive))
    return [dive for _, dive in sorted(wanted)]


def duration(seconds):
    minutes = int(round(seconds / 60))
    if minutes < 2:
        return f"{seconds:.0f} s"
    return f"{minutes // 60} h {minutes % 60} min" if minutes >= 60 else f"{minutes} min"


def tell(mission, binary, quality, deadline):
    """What is to come takes, as far as it is not done."""
    sums, disk = {"coarse": 0.0, "full": 0.0}, 0
    program = dives.checksum(binary)
    names = dives.dives(mission)
    share = load.share_to_be_had()
    for dive in names:
        estimated = estimate(mission, dive, binary, quality)
        dive_digest = dives.digest(mission, dive)
        if dives.is_current(dives.outcome(mission, dive), dive_digest, quality, program):
            continue
        sums["full"] += seconds_of("full", estimated) / share
        disk += (estimated or {}).get("disk_bytes", 0)
        coarse = dives.outcome(mission, dive, "coarse")
        if deadline != "never" and not dives.is_current(coarse, dive_digest, "coarse", program):
            sums["coarse"] += seconds_of("coarse", estimated) / share
    free = os.statvfs(mission)
    text = f"{len(names)} dives; about {duration(sums['full'])} in full"
    if deadline != "never":
        left = max(0.0, deadlines.seconds_left(deadline))
        text += (f", after {duration(sums['coarse'])} for a coarse answer of each; "
                 f"{duration(left)} until {deadlines.clock(deadline)}")
        if sum(sums.values()) > left:
            text += ": some will stay coarse"
    if share < 0.9:
        text += f"; others leave {100 * share:.0f} % of this machine"
    dives.say(mission, f"{text}; disk: up to {disk / 1e9:.1f} GB of "
                       f"{free.f_bavail * free.f_frsize / 1e9:.1f} GB free")
    record = {"coarse_seconds": round(sums["coarse"], 1), "full_seconds": round(sums["full"], 1)}
    dives.write_whole(os.path.join(mission, dives.RESULTS, "estimate.json"),
                      json.dumps(record) + "\n")


def main(arguments):
    if arguments[0] == "deadline":
        try:
            print(deadlines.after_hours(arguments[2]) if arguments[1] == "--hours"
                  else deadlines.at_time(arguments[2]))
        except ValueError as error:
            print(f"{arguments[1]} {error}", file=sys.stderr)
            return 2
    elif arguments[0] == "tell":
        tell(*arguments[1:])
    elif arguments[0] == "must_stop":
        return 0 if deadlines.seconds_left(arguments[1]) <= 0 else 1
    else:
        raise SystemExit(__doc__)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
