"""Smaller copies of a dive's pictures, for its coarse answer."""
import concurrent.futures
import json
import os
import shutil

from PIL import Image

import dives

LONGER_SIDE = 560  # pixels
# Of whoever gives these the pixels count: pictures stay as they are.
IN_PIXELS = ("camera_params", "mask_path", "targets_path", "marker_size", "scale_bars_path")


def counts_in_pixels(project):
    if project is None:
        return False
    with open(project, encoding="utf-8", errors="replace") as file:
        return any(line.split("=")[0].strip().rpartition(".")[2] in IN_PIXELS for line in file)


def read_reduced(source):
    """The picture made smaller, and its format; None for what is small already, or no picture that can
    be read here: the program says what it is."""
    try:
        with Image.open(source) as picture:
            kind = picture.format
            if max(picture.size) <= LONGER_SIDE or kind not in ("JPEG", "PNG", "TIFF"):
                return None
            picture.draft(None, (LONGER_SIDE, LONGER_SIDE))
            picture.thumbnail((LONGER_SIDE, LONGER_SIDE), Image.Resampling.BOX)
            return picture.copy(), kind
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return None


def reduce_one(source, target):
    """A smaller copy in the same format, with the same EXIF, and True; or a link, and False."""
    os.makedirs(os.path.dirname(target), exist_ok=True)
    reduced = read_reduced(source)
    if reduced is None:
        os.symlink(os.path.abspath(source), target)
        return False
    picture, kind = reduced
    kept = {"exif": picture.info["exif"]} if "exif" in picture.info else {}
    picture.save(target, kind, quality=92, **kept)
    return True


def folder_of(mission, dive, dive_digest):
    """Where the dive's smaller pictures are: made when they are not there yet. Its own pictures where
    none is made smaller, or its options count in their pixels."""
    source = dives.image_path(mission, dive)
    if counts_in_pixels(dives.project_path(mission, dive)):
        return source
    target = dives.result_path(mission, dive, "coarse/images")
    record = dives.result_path(mission, dive, "coarse/images.json")
    made_of = [dive_digest, LONGER_SIDE]
    known = dives.read_json(record) or {}
    if known.get("made_of") == made_of:
        return target if known["num_reduced"] else source
    shutil.rmtree(target, ignore_errors=True)
    jobs = []
    for root, folders, files in os.walk(source, followlinks=True):
        folders.sort()
        for name in sorted(files):
            path = os.path.join(root, name)
            jobs.append((path, os.path.join(target, os.path.relpath(path, source))))
    os.makedirs(target, exist_ok=True)
    # Not in threads: Pillow closes the file descriptors of TIFFs twice.
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count()) as pool:
        num_reduced = sum(pool.map(reduce_one, *zip(*jobs), chunksize=8)) if jobs else 0
    dives.write_whole(record, json.dumps({"made_of": made_of, "num_reduced": num_reduced}))
    return target if num_reduced else source
