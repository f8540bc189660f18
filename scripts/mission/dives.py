"""What a mission consists of and what became of it, for run_mission.sh and its Snakefile.

dives.py list MISSION            a line a dive: what its files hold, and its name
dives.py forget_failed MISSION   steps that failed, or were stopped, will be tried again
dives.py follow MISSION          what the logs say from now on, until it is stopped
dives.py summary MISSION         a line a dive; exits with 0, 3 or 1
"""
import hashlib
import json
import os
import signal
import sys
import time

RESULTS = "results"
INCOMPLETE = 3  # automatic_reconstructor: done, but for pictures that it names
# The steps of a dive. Each leaves <step's record>, <log> and <workspace> in the dive's results.
RECORDS = {"coarse": "coarse.json", "full": "outcome.json"}
LOGS = {"coarse": "coarse_log.txt", "full": "log.txt"}
WORKSPACES = {"coarse": "coarse/workspace", "full": "workspace"}


def dives(mission):
    """Names of the dives: the folders of a mission, in the order of their names."""
    return sorted(
        entry.name for entry in os.scandir(mission)
        if entry.is_dir() and entry.name != RESULTS and not entry.name.startswith("."))


def image_path(mission, dive):
    folder = os.path.join(mission, dive)
    for name in ("images", "video"):
        if os.path.isdir(os.path.join(folder, name)):
            return os.path.join(folder, name)
    return folder


def project_path(mission, dive):
    """The dive's own options; None where it has none."""
    path = os.path.join(mission, dive, "project.ini")
    return path if os.path.isfile(path) else None


def result_path(mission, dive, name=""):
    return os.path.join(mission, RESULTS, dive, name)


def say(mission, text):
    """Into the mission's log, with the time; follow() brings it to the terminal."""
    with open(os.path.join(mission, RESULTS, "log.txt"), "a", encoding="utf-8") as log:
        log.write(time.strftime("%Y-%m-%d %H:%M:%S ") + text + "\n")


def write_whole(path, text):
    """The file has the text or is as it was, whatever happens."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    temporary = f"{path}.{os.getpid()}.tmp"
    with open(temporary, "w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    os.replace(temporary, path)


def read_json(path):
    """None where there is no such file, or it is damaged."""
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError):
        return None


def checksum(path):
    sum_of = hashlib.blake2b(digest_size=16)
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            sum_of.update(block)
    return sum_of.hexdigest()


def digest(mission, dive):
    """Of the names and bytes of all files of a dive. Files whose size and date are as they were are
    not read again; a file with another date is, and counts as the same when it holds the same."""
    cache_path = result_path(mission, dive, "checksums.json")
    cache = read_json(cache_path)
    if not isinstance(cache, dict):
        cache = {}
    known, whole = {}, hashlib.blake2b(digest_size=16)
    folder = os.path.join(mission, dive)
    for root, folders, files in os.walk(folder, followlinks=True):
        folders.sort()
        for name in sorted(files):
            path = os.path.join(root, name)
            relative = os.path.relpath(path, folder)
            try:
                status = os.stat(path)
                stamp = [status.st_size, status.st_mtime_ns]
                entry = cache.get(relative)
                if not entry or entry[:2] != stamp:
                    entry = stamp + [checksum(path)]
            except OSError:
                continue  # automatic_reconstructor names what cannot be read
            known[relative] = entry
            whole.update(f"{relative}\0{entry[2]}\0".encode("utf-8", "surrogateescape"))
    if known != cache:
        write_whole(cache_path, json.dumps(known))
    return whole.hexdigest()


def outcome(mission, dive, step="full"):
    return read_json(result_path(mission, dive, RECORDS[step]))


def has_failed(result):
    return not result or result.get("exit_code") not in (0, INCOMPLETE)


def is_current(result, dive_digest, quality, program):
    """Whether a step came out, and of these files, at this quality, by this program."""
    made_of = [result.get(key) for key in ("digest", "quality", "program")] if result else None
    return not has_failed(result) and made_of == [dive_digest, quality, program]


def last_begun(mission, dive):
    """The record of the last step that was begun; None where none was."""
    results = [outcome(mission, dive, step) for step in RECORDS]
    begun = [result for result in results if result and result.get("seconds") is not None]
    return begun[-1] if begun else None


def state(mission, dive):
    """What there is of a dive: "full", "coarse", "stopped" by a deadline before there was anything,
    "failed" or "not begun"; and why it is not more."""
    results = {step: outcome(mission, dive, step) for step in RECORDS}
    if not has_failed(results["full"]):
        return "full", ""
    reason = (results["full"] or {}).get("error") or "not begun"
    if not has_failed(results["coarse"]):
        return "coarse", reason
    begun = last_begun(mission, dive)
    if not begun:
        return "not begun", reason if results["full"] else ""
    if begun["exit_code"] is None:
        return "stopped", begun["error"].removeprefix("stopped ")
    return "failed", begun.get("error", "")


def forget_failed(mission):
    for dive in dives(mission):
        for step, record in RECORDS.items():
            if has_failed(outcome(mission, dive, step)):
                try:
                    os.remove(result_path(mission, dive, record))
                except FileNotFoundError:
                    pass


def write_page(mission):
    import mission_page  # which is made of what stands here
    write_whole(os.path.join(mission, RESULTS, "mission.html"), mission_page.page(mission))


def last_line(path):
    """As a list of one, or of none."""
    try:
        with open(path, "rb") as log:
            log.seek(max(0, os.fstat(log.fileno()).st_size - 1000))
            lines = log.read().decode("utf-8", "replace").splitlines()
    except OSError:
        lines = []
    return lines[-1:]


def follow(mission):
    """What is new in the mission's own log, and the newest line of each dive's log that has grown,
    after the name of its dive, every five seconds."""
    def sizes():
        found = {}
        for dive in dives(mission):
            for name in LOGS.values():
                path = result_path(mission, dive, name)
                found[path] = (dive, os.path.getsize(path) if os.path.exists(path) else 0)
        return found

    own = open(os.path.join(mission, RESULTS, "log.txt"), "a+", encoding="utf-8")
    own.seek(0, os.SEEK_END)
    before = sizes()

    def tell_the_rest(*_):
        sys.stderr.write(own.read())
        sys.exit(0)

    signal.signal(signal.SIGTERM, tell_the_rest)
    parent = os.getppid()
    while os.getppid() == parent:  # a signal may come before it is heard
        time.sleep(5)
        sys.stderr.write(own.read())
        try:
            now = sizes()
        except OSError:
            continue  # the mission's disk is gone: run_mission.sh says so
        for path, (dive, size) in now.items():
            if size and (dive, size) != before.get(path):
                for line in last_line(path):
                    print(f"{dive}: {line}", file=sys.stderr)
        sys.stderr.flush()
        before = now


def answer(mission, dive, step="full"):
    """The first line of the dive's summary, and what of the ground is covered."""
    path = result_path(mission, dive, WORKSPACES[step] + "/report/summary.txt")
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            lines = [line.strip() for line in file]
    except OSError:
        return ""
    covered = [line[len("completeness: "):] for line in lines if line.startswith("completeness: ")]
    return "; ".join(lines[:1] + covered)


def summary(mission):
    write_page(mission)
    exit_codes = []
    for dive in dives(mission):
        what, reason = state(mission, dive)
        exit_codes.append(outcome(mission, dive)["exit_code"] if what == "full" else what)
        if what == "full":
            left_out = ", not whole" if exit_codes[-1] == INCOMPLETE else ""
            print(f"{dive}: {answer(mission, dive)}{left_out}")
        elif what == "coarse":
            print(f"{dive}: COARSE: {answer(mission, dive, 'coarse')} (in full: {reason})")
        else:
            print(f"{dive}: {what.upper()}{': ' if reason else ''}{reason}")
    print(f"page: {os.path.join(mission, RESULTS, 'mission.html')}")
    if all(code in ("stopped", "failed", "not begun") for code in exit_codes):
        return 1
    return 0 if all(code == 0 for code in exit_codes) else INCOMPLETE


def main(arguments):
    command, mission = arguments[0], arguments[1]
    if command == "list":
        for dive in dives(mission):
            print(digest(mission, dive), dive)
    elif command == "forget_failed":
        forget_failed(mission)
    elif command == "follow":
        follow(mission)
    elif command == "summary":
        return summary(mission)
    else:
        raise SystemExit(__doc__)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
