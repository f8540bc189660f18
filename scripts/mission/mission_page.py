"""The page of a mission: a card a dive: its answer, its map, what failed and why.

The page opens from disk without a network; pictures are linked, relative to it.
"""
import html
import os
import time
import urllib.parse

import dives
from plan import duration

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
li.failed, li.stopped, li.not-begun { border-style: dashed; }
li.coarse { border-style: double; border-width: 4px; }
.state { font-weight: bold; }
img { width: 100%; height: 15rem; object-fit: contain; margin-top: .5rem; }
a { color: #00449e; }
a:focus-visible { outline: 3px solid #000; }
"""


def link(path):
    return html.escape(urllib.parse.quote(path), quote=True)


def maps_of(results, workspace):
    """Previews of the dive's maps, relative to the page."""
    found = []
    for root, folders, files in os.walk(os.path.join(results, workspace, "map")):
        folders.sort()
        if "orthomosaic.jpg" in files:
            found.append(os.path.relpath(os.path.join(root, "orthomosaic.jpg"), results))
    return found


def first_five(lines):
    return lines[:5] + ([f"and {len(lines) - 5} more"] if len(lines) > 5 else [])


def left_out(report):
    """A line for each thing that the dive's run left out, five at most."""
    return first_five([f"{entry.get('name')}: {entry.get('reason')}"
                       for entry in report.get("left_out", [])])


def seconds_of(report):
    """Of all its stages, in whatever run they were done: the last one may have found them there."""
    return sum(stage.get("wall_seconds", 0) for stage in report.get("stages", []))


def why_failed(mission, dive):
    """What the program warned of before it gave up, and what to do then."""
    warnings = (dives.last_begun(mission, dive) or {}).get("warnings", [])
    return [f"<p>{html.escape(line)}</p>" for line in first_five(warnings)] + [
        "<p>Once that is mended in the dive’s folder, <b>" + html.escape(dive) +
        "</b>, the same command tries it again; the other dives stay as they are.</p>"]


def state_line(mission, dive, what, reason):
    if what == "full":
        is_whole = dives.outcome(mission, dive)["exit_code"] == 0
        word, text = ("Whole." if is_whole else "Done, not whole."), dives.answer(mission, dive)
    elif what == "coarse":
        word, text = "Coarse answer.", f"{dives.answer(mission, dive, 'coarse')}. In full: {reason}."
    else:
        # From the mission's folder on: paths are long on a phone.
        word = what.capitalize() + ("" if what == "stopped" else ".")
        text = reason.replace(os.path.join(os.path.abspath(mission), ""), "")
    return f'<p><span class="state">{word}</span> {html.escape(text)}</p>'


def links(results, dive, paths):
    """To what there is of those files of a dive, by what they are called."""
    lines = []
    for name, path in paths.items():
        if os.path.exists(os.path.join(results, dive, path)):
            lines.append(f'<p><a href="{link(os.path.join(dive, path))}">{name} ('
                         f"{html.escape(dive)})</a></p>")
    return lines


def reports_of(step):
    workspace = dives.WORKSPACES[step]
    return {"Report": workspace + "/report/index.html", "Summary": workspace + "/report/summary.txt"}


def card(mission, results, dive):
    what, reason = dives.state(mission, dive)
    lines = [f"<h2>{html.escape(dive)}</h2>", state_line(mission, dive, what, reason)]
    if what in ("full", "coarse"):
        result = dives.outcome(mission, dive, what)
        workspace = os.path.join(dive, dives.WORKSPACES[what])
        report = dives.read_json(os.path.join(results, workspace, "report/run.json")) or {}
        lines += [f"<p>Left out: {html.escape(line)}</p>" for line in left_out(report)]
        for picture in maps_of(results, workspace):
            full = os.path.join(os.path.dirname(picture), "orthomosaic.tif")
            target = full if os.path.exists(os.path.join(results, full)) else picture
            lines.append(f'<a href="{link(target)}"><img src="{link(picture)}" loading="lazy" '
                         f'alt="Orthomosaic of {html.escape(dive, quote=True)}"></a>')
        lines += links(results, dive, reports_of(what))
        lines.append(f"<p>Quality: {html.escape(result['quality'])}; it took "
                     f"{duration(seconds_of(report))}.</p>")
    else:
        if what == "failed":
            lines += why_failed(mission, dive)
        lines += links(results, dive, {
            **reports_of("full"), "All that it said": dives.LOGS["full"],
            "All that the coarse run said": dives.LOGS["coarse"]})
    return f'<li id="{anchor(dive)}" class="{what.replace(" ", "-")}">' + "\n".join(lines) + "</li>"


def anchor(dive):
    return html.escape(urllib.parse.quote("dive-" + dive), quote=True)


def named(word, names):
    """Which dives it is true of, with links to their cards; "" where it is none."""
    links_to = ", ".join(f'<a href="#{anchor(dive)}">{html.escape(dive)}</a>' for dive in names)
    return f"<p>{word}: {links_to}.</p>\n" if names else ""


def page(mission):
    results = os.path.join(mission, dives.RESULTS)
    names = dives.dives(mission)
    states = {dive: dives.state(mission, dive)[0] for dive in names}
    of_state = {what: [dive for dive in names if states[dive] == what]
                for what in ("full", "coarse", "failed", "stopped", "not begun")}
    num_coarse = len(of_state["coarse"])
    num_good = len(of_state["full"]) + num_coarse
    title = os.path.basename(os.path.normpath(mission))
    cards = "\n".join(card(mission, results, dive) for dive in names)
    when = time.strftime("%Y-%m-%d %H:%M")
    coarse = f", {num_coarse} of them coarse" if num_coarse else ""
    not_out = "".join(named(what.capitalize(), of_state[what])
                      for what in ("failed", "stopped", "not begun"))
    return (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>{html.escape(title)}</title><style>{STYLE}</style></head>\n<body><main>\n"
            f"<h1>{html.escape(title)}</h1>\n<p>{num_good} of {len(names)} dives came out{coarse}. "
            f"{when}</p>\n{not_out}<ul>\n{cards}\n</ul>\n</main></body></html>\n")
