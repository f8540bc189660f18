"""The page of a mission: a card a dive: its answer, its map, what failed and why.

The page opens from disk without a network; pictures are linked, relative to it.
"""
import html
import os
import time
import urllib.parse

import dives

STYLE = """
:root { color-scheme: light; }
body { font: 1.05rem/1.45 system-ui, sans-serif; margin: 0 auto; padding: 1rem; max-width: 75rem;
  color: #000; background: #fff; }
h1 { font-size: 1.6rem; margin: 0 0 .3rem; }
h2 { font-size: 1.2rem; margin: 0; overflow-wrap: anywhere; }
p { margin: .4rem 0; overflow-wrap: anywhere; }
ul { list-style: none; margin: 1rem 0 0; padding: 0; display: grid; gap: 1rem;
  align-items: start; grid-template-columns: repeat(auto-fill, minmax(min(100%, 21rem), 1fr)); }
li { border: 2px solid #000; border-radius: .4rem; padding: .8rem; break-inside: avoid; }
li.failed { border-style: dashed; }
.state { font-weight: bold; }
img { width: 100%; height: 15rem; object-fit: contain; background: #eee; margin-top: .5rem; }
a { color: #00449e; }
a:focus-visible { outline: 3px solid #000; }
"""


def link(path):
    return html.escape(urllib.parse.quote(path), quote=True)


def duration(seconds):
    minutes = int(round(seconds / 60))
    if minutes < 1:
        return f"{seconds:.0f} s"
    return f"{minutes // 60} h {minutes % 60} min" if minutes >= 60 else f"{minutes} min"


def maps_of(results, dive):
    """Previews of the dive's maps, relative to the page."""
    found = []
    for root, folders, files in os.walk(os.path.join(results, dive, "workspace", "map")):
        folders.sort()
        if "orthomosaic.jpg" in files:
            found.append(os.path.relpath(os.path.join(root, "orthomosaic.jpg"), results))
    return found


def left_out(results, dive):
    """A line for each thing that the dive's run left out, five at most."""
    report = dives.read_json(os.path.join(results, dive, "workspace/report/run.json")) or {}
    entries = [f"{entry.get('name')}: {entry.get('reason')}" for entry in report.get("left_out", [])]
    more = [f"and {len(entries) - 5} more"] if len(entries) > 5 else []
    return entries[:5] + more


def card(mission, results, dive):
    result = dives.outcome(mission, dive)
    lines = [f"<h2>{html.escape(dive)}</h2>"]
    if dives.has_failed(result):
        reason = (result or {}).get("error") or "not run"
        lines.append(f'<p><span class="state">Failed.</span> {html.escape(reason)}</p>')
        log = os.path.join(dive, "log.txt")
        if os.path.exists(os.path.join(results, log)):
            lines.append(f'<p><a href="{link(log)}">All that it said ({html.escape(dive)})</a></p>')
        return '<li class="failed">' + "\n".join(lines) + "</li>"
    is_whole = result["exit_code"] == 0
    state = "Whole." if is_whole else "Done, not whole."
    lines.append(f'<p><span class="state">{state}</span> '
                 f"{html.escape(dives.answer(mission, dive))}</p>")
    lines += [f"<p>Left out: {html.escape(line)}</p>" for line in left_out(results, dive)]
    for picture in maps_of(results, dive):
        full = os.path.join(os.path.dirname(picture), "orthomosaic.tif")
        target = full if os.path.exists(os.path.join(results, full)) else picture
        lines.append(f'<a href="{link(target)}"><img src="{link(picture)}" loading="lazy" '
                     f'alt="Orthomosaic of {html.escape(dive, quote=True)}"></a>')
    for name, path in (("Report", "workspace/report/index.html"),
                       ("Summary", "workspace/report/summary.txt")):
        if os.path.exists(os.path.join(results, dive, path)):
            lines.append(f'<p><a href="{link(os.path.join(dive, path))}">{name} of '
                         f"{html.escape(dive)}</a></p>")
    lines.append(f"<p>{html.escape(result['quality'])}, {duration(result['seconds'])}</p>")
    return "<li>" + "\n".join(lines) + "</li>"


def page(mission):
    results = os.path.join(mission, dives.RESULTS)
    names = dives.dives(mission)
    num_good = sum(not dives.has_failed(dives.outcome(mission, dive)) for dive in names)
    title = os.path.basename(os.path.normpath(mission))
    cards = "\n".join(card(mission, results, dive) for dive in names)
    when = time.strftime("%Y-%m-%d %H:%M")
    return (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>{html.escape(title)}</title><style>{STYLE}</style></head>\n<body><main>\n"
            f"<h1>{html.escape(title)}</h1>\n<p>{num_good} of {len(names)} dives came out. "
            f"{when}</p>\n<ul>\n{cards}\n</ul>\n</main></body></html>\n")
