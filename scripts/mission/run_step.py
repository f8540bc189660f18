"""run_step.py STEP MISSION DIVE BINARY QUALITY DIGEST DEADLINE PAUSE_ON_BATTERY

A step of a dive, coarse or full: its workspace, its log, its record, and the page over all. Whatever
becomes of it, it ends well, since others are to follow; its record tells. At the deadline the
program is stopped: what it has finished by then is kept, and the next run goes on from there.
"""
import json
import os
import shutil
import signal
import subprocess
import sys
import time

import deadline as deadlines
import dives
import load
import plan
import reduced_pictures

# What makes an answer coarse, beside smaller pictures and the quality "field". Measured on a demo
# survey of 30 pictures and two AUV strips of 1.4 megapixels: a sixth of the full run's CPU time, and a
# covered share, at four to five times the spacing, within 4 to 7 points of its.
COARSE_OPTIONS = {
    "SeaPointExtraction.min_num_features": "600",
    "SeaPointExtraction.max_num_features": "800",
    "PartialDensification.step": "2",
}
SECONDS_TO_END = 20  # of a program that was asked to


def lines_of(log_path):
    try:
        with open(log_path, encoding="utf-8", errors="replace") as log:
            return [line.strip() for line in log]
    except OSError:
        return []


def said(log_path, beginning):
    """The lines of a log that begin so, without that."""
    return [line[len(beginning):].strip() for line in lines_of(log_path) if line.startswith(beginning)]


def why_it_failed(exit_code, log_path):
    if exit_code >= 0:
        return (said(log_path, "error:") or [f"ended with exit code {exit_code}"])[-1]
    # It had no time for a last word; the line before says what it was at.
    lines = [line for line in lines_of(log_path) if line]
    return (f"was killed by signal {-exit_code} ({signal.strsignal(-exit_code)})"
            + (", by the system for want of memory or by somebody: close other programs"
               if exit_code == -signal.SIGKILL else "")
            + "; the same command goes on from there"
            + (f". Its last line: {lines[-1]}" if lines else ""))


def coarse_command(mission, dive, binary, dive_digest):
    command = plan.command_of(mission, dive, binary, "field")
    images = reduced_pictures.folder_of(mission, dive, dive_digest)
    command[command.index("--image_path") + 1] = images
    command[command.index("--workspace_path") + 1] = dives.result_path(
        mission, dive, dives.WORKSPACES["coarse"])
    for name, value in COARSE_OPTIONS.items():
        command += ["--" + name, value]
    return command


def run_until(command, log_path, deadline, environment):
    """Exit code; None where it was stopped at the deadline."""
    with open(log_path, "w", encoding="utf-8") as log:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log,
                                   stderr=subprocess.STDOUT, env=environment)
        while process.poll() is None:
            left = deadlines.seconds_left(deadline)
            if left <= 0:
                process.terminate()
                try:
                    process.wait(SECONDS_TO_END)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
                return None
            try:
                # Not longer: a clock that is set, or a machine that slept, is noticed.
                process.wait(min(left, 1.0))
            except subprocess.TimeoutExpired:
                pass
    return process.returncode


def environment_of(step):
    """The program learns from its own runs how fast the machine is: not from coarse ones."""
    environment = dict(os.environ)
    if step == "coarse":
        environment["XDG_CACHE_HOME"] = plan.cache_path("coarse")
    return environment


def command_of(step, mission, dive, binary, quality, dive_digest, pause_on_battery):
    command = (coarse_command(mission, dive, binary, dive_digest) if step == "coarse"
               else plan.command_of(mission, dive, binary, quality))
    return command + (["--pause_on_battery", pause_on_battery] if pause_on_battery else [])


def run_program(step, mission, dive, binary, quality, dive_digest, deadline, pause_on_battery):
    """Exit code, None where it was stopped; and what went wrong."""
    log_path = dives.result_path(mission, dive, dives.LOGS[step])
    os.makedirs(os.path.dirname(log_path), exist_ok=True)
    try:
        command = command_of(step, mission, dive, binary, quality, dive_digest, pause_on_battery)
        exit_code = run_until(command, log_path, deadline, environment_of(step))
    except Exception as error:  # whatever it is: the other dives are to follow
        return 1, f"{type(error).__name__}: {error}"
    if exit_code is None:
        return None, f"stopped at {deadlines.clock(deadline)}, goes on with the same command"
    if exit_code in (0, dives.INCOMPLETE):
        return exit_code, ""
    return exit_code, why_it_failed(exit_code, log_path)


def run(step, mission, dive, binary, quality, dive_digest, deadline, pause_on_battery=""):
    record = {"dive": dive, "digest": dive_digest, "program": dives.checksum(binary),
              "quality": "coarse" if step == "coarse" else quality, "exit_code": None,
              "seconds": None, "ended": 0, "error": "not begun by the deadline"}
    if deadlines.seconds_left(deadline) > 0:
        dives.say(mission, f"{dive}: {step} begun")
        is_new = not os.path.exists(dives.result_path(mission, dive, dives.WORKSPACES[step]))
        share = load.share_to_be_had()
        began = time.monotonic()  # which neither a clock that is set nor a closed lid changes
        record["exit_code"], record["error"] = run_program(
            step, mission, dive, binary, quality, dive_digest, deadline, pause_on_battery)
        record["warnings"] = said(dives.result_path(mission, dive, dives.LOGS[step]), "warning:")
        record["seconds"] = round(time.monotonic() - began, 1)
        dives.say(mission, f"{dive}: {step} {record['error'] or 'done'} after {record['seconds']} s")
    record["ended"] = int(time.time())
    dives.write_whole(dives.result_path(mission, dive, dives.RECORDS[step]),
                      json.dumps(record, indent=2) + "\n")
    if not dives.has_failed(record):
        if is_new:
            plan.remember(step, record["seconds"], (share + load.share_to_be_had()) / 2,
                          plan.estimate(mission, dive, binary, quality))
        if step == "full":
            shutil.rmtree(dives.result_path(mission, dive, "coarse"), ignore_errors=True)
    try:
        dives.write_page(mission)
    except Exception as error:  # the dive stands without it; the summary writes it once more
        dives.say(mission, f"{dive}: the page was not written: {error}")


if __name__ == "__main__":
    run(*sys.argv[1:])
