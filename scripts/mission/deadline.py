"""When a mission has to be over.

As text: "never"; "at 1764480000" seconds since 1970, by the clock on the wall, which somebody
may set; "after 12345.6" seconds of this machine since its start, those that it slept through too.
"""
import re
import time


def uptime():
    return time.clock_gettime(time.CLOCK_BOOTTIME)


def after_hours(hours):
    return f"after {uptime() + 3600 * float(hours):.3f}"


def at_time(text, now=None):
    """The next time that the clock shows HH:MM. ValueError for what is no time."""
    match = re.fullmatch(r"(\d{1,2}):(\d{2})", text)
    if not match or int(match[1]) > 23 or int(match[2]) > 59:
        raise ValueError(f"{text}: give a time of the day, 06:00")
    now = time.time() if now is None else now
    day = list(time.localtime(now))
    day[3:6] = int(match[1]), int(match[2]), 0
    day[8] = -1  # summer time as it is then
    found = time.mktime(time.struct_time(day))
    if found <= now:
        day[2] += 1
        found = time.mktime(time.struct_time(day))
    return f"at {found:.0f}"


def seconds_left(deadline):
    if deadline == "never":
        return float("inf")
    kind, seconds = deadline.split()
    return float(seconds) - (time.time() if kind == "at" else uptime())


def clock(deadline):
    """ "06:00" """
    return time.strftime("%H:%M", time.localtime(time.time() + seconds_left(deadline)))
