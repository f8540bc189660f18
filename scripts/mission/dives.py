"""What a mission consists of and what became of it, for run_mission.sh and its Snakefile.

dives.py list MISSION            a line a dive: what its files hold, and its name
dives.py forget_failed MISSION   dives that failed will be tried again
dives.py run MISSION DIVE BINARY QUALITY DIGEST    automatic_reconstructor on one dive, and the page
dives.py follow MISSION          what the dives' logs say from now on, until it is stopped
dives.py summary MISSION         a line a dive; exits with 0, 3 or 1
"""
import hashlib
import json
import os
import subprocess
import sys
import time

RESULTS = "results"
INCOMPLETE = 3  # automatic_reconstructor: done, but for pictures that it names


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


def result_path(mission, dive, name=""):
    return os.path.join(mission, RESULTS, dive, name)


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


def outcome(mission, dive):
    return read_json(result_path(mission, dive, "outcome.json"))


def has_failed(result):
    return not result or result.get("exit_code") not in (0, INCOMPLETE)


def forget_failed(mission):
    for dive in dives(mission):
        if has_failed(outcome(mission, dive)):
            try:
                os.remove(result_path(mission, dive, "outcome.json"))
            except FileNotFoundError:
                pass


def last_error(log_path):
    """The last line of a log that begins with "error:", without that."""
    found = ""
    try:
        with open(log_path, encoding="utf-8", errors="replace") as log:
            for line in log:
                if line.startswith("error:"):
                    found = line[len("error:"):].strip()
    except OSError:
        pass
    return found


def run(mission, dive, binary, quality, dive_digest):
    """Writes what became of the dive, whatever it is, and ends well: others are to follow."""
    log_path = result_path(mission, dive, "log.txt")
    os.makedirs(os.path.dirname(log_path), exist_ok=True)
    command = [binary, "automatic_reconstructor", "--image_path", image_path(mission, dive),
               "--workspace_path", result_path(mission, dive, "workspace"), "--quality", quality]
    project = os.path.join(mission, dive, "project.ini")
    if os.path.isfile(project):
        command += ["--project_path", project]
    began = time.time()
    with open(log_path, "w", encoding="utf-8") as log:
        exit_code = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=log,
                                   stderr=subprocess.STDOUT, check=False).returncode
    result = {"dive": dive, "digest": dive_digest, "quality": quality, "exit_code": exit_code,
              "seconds": round(time.time() - began, 1), "ended": int(time.time()),
              "error": "" if exit_code in (0, INCOMPLETE) else
                       last_error(log_path) or f"ended with exit code {exit_code}"}
    write_whole(result_path(mission, dive, "outcome.json"), json.dumps(result, indent=2) + "\n")
    write_page(mission)


def write_page(mission):
    import mission_page  # which is made of what stands here
    write_whole(os.path.join(mission, RESULTS, "mission.html"), mission_page.page(mission))


def follow(mission):
    """The newest line of each log that has grown, every five seconds, after the name of its dive."""
    def size_of(dive):
        try:
            return os.path.getsize(result_path(mission, dive, "log.txt"))
        except OSError:
            return 0

    sizes = {dive: size_of(dive) for dive in dives(mission)}
    while True:
        time.sleep(5)
        for dive in dives(mission):
            size = size_of(dive)
            if size == sizes.get(dive, 0):
                continue
            sizes[dive] = size
            try:
                with open(result_path(mission, dive, "log.txt"), "rb") as log:
                    log.seek(max(0, size - 1000))
                    lines = log.read().decode("utf-8", "replace").splitlines()
            except OSError:
                continue
            if lines:
                print(f"{dive}: {lines[-1]}", file=sys.stderr, flush=True)


def answer(mission, dive):
    """The first line of the dive's summary."""
    try:
        path = result_path(mission, dive, "workspace/report/summary.txt")
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.readline().strip()
    except OSError:
        return ""


def summary(mission):
    write_page(mission)
    names = dives(mission)
    results = {dive: outcome(mission, dive) for dive in names}
    for dive, result in results.items():
        if has_failed(result):
            print(f"{dive}: FAILED: {(result or {}).get('error') or 'not run'}")
        else:
            left_out = ", not whole" if result["exit_code"] == INCOMPLETE else ""
            print(f"{dive}: {answer(mission, dive)}{left_out}")
    print(f"page: {os.path.join(mission, RESULTS, 'mission.html')}")
    if all(has_failed(result) for result in results.values()):
        return 1
    is_whole = all(result and result.get("exit_code") == 0 for result in results.values())
    return 0 if is_whole else INCOMPLETE


def main(arguments):
    command, mission = arguments[0], arguments[1]
    if command == "list":
        for dive in dives(mission):
            print(digest(mission, dive), dive)
    elif command == "forget_failed":
        forget_failed(mission)
    elif command == "run":
        run(mission, *arguments[2:])
    elif command == "follow":
        follow(mission)
    elif command == "summary":
        return summary(mission)
    else:
        raise SystemExit(__doc__)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
