#!/usr/bin/env python3
"""The part that is drawn in space, against the half section that is cut.

`part_moments` cuts the samples 01 to 04 and writes, at evenly spaced moments, the polygons of
the half section and the triangles of the drawn part. This turns the triangles by an angle of
the spindle, sees them from the side, as a parallel camera does, and compares the silhouette
with the shadow of the polygons on a grid of pixels (shapely):

  no pixel of the silhouette is more than a pixel outside of the polygons
  no pixel of the polygons is more than a pixel outside of the silhouette

The bore is compared, too: in the plane of the axis the triangles leave lines. They are on the
outline of the polygons within a pixel, and all of the outline off the axis has a line near it.

    cargo build --release -p gsk980td-tests --bin part_moments
    python3 tests/oracles/part_silhouette.py --program target/release/part_moments
"""

import argparse
import json
import math
import pathlib
import subprocess
import sys

import numpy
import shapely
from shapely.geometry import Polygon, box
from shapely.ops import unary_union

SAMPLES = [
    ["01-stepped-shaft"],
    ["02-bushing"],
    ["03-grooved-pin", "O1031"],
    ["04-manual-example"],
]
PIXELS_PER_MM = 3.0
PIXEL = 1.0 / PIXELS_PER_MM
MARGIN = 4  # pixels around the part


def read_moments(command):
    """Yields (time, polygons, triangles as an array [count, corner, coordinate])."""
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        for line in process.stdout:
            moment = json.loads(line)
            data = process.stdout.read(moment["triangles"] * 36)
            corners = numpy.frombuffer(data, "<f4").reshape(-1, 3, 3).astype(float)
            yield moment["time"], moment["section"], corners
    if process.returncode:
        sys.exit(f"{command} ended with {process.returncode}")


def turned(corners, angle):
    """The triangles after a turn of the spindle."""
    sine, cosine = math.sin(angle), math.cos(angle)
    x, y, z = corners[..., 0], corners[..., 1], corners[..., 2]
    return numpy.stack([x, y * cosine - z * sine, y * sine + z * cosine], axis=-1)


def silhouette(corners, left, columns):
    """Greatest height of the triangles above the axis at the middle of each pixel column."""
    heights = numpy.zeros(columns)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        start, end = corners[:, a, :2], corners[:, b, :2]
        swap = start[:, 0] > end[:, 0]
        start, end = (
            numpy.where(swap[:, None], end, start),
            numpy.where(swap[:, None], start, end),
        )
        # Columns whose middle an edge covers.
        first = numpy.ceil((start[:, 0] - left) * PIXELS_PER_MM - 0.5).astype(int)
        last = numpy.floor((end[:, 0] - left) * PIXELS_PER_MM - 0.5).astype(int)
        counts = numpy.maximum(last - first + 1, 0)
        edge = numpy.repeat(numpy.arange(len(counts)), counts)
        steps = numpy.arange(len(edge)) - numpy.repeat(numpy.cumsum(counts) - counts, counts)
        column = first[edge] + steps
        x = left + (column + 0.5) * PIXEL
        length = end[edge, 0] - start[edge, 0]
        share = numpy.where(length > 0, (x - start[edge, 0]) / numpy.where(length > 0, length, 1), 0)
        y = start[edge, 1] + (end[edge, 1] - start[edge, 1]) * share
        inside = (column >= 0) & (column < columns)
        numpy.maximum.at(heights, column[inside], y[inside])
    return heights


def axis_lines(corners):
    """The lines that the triangles leave in the upper half of the plane of the axis."""
    y, z = corners[..., 1], corners[..., 2]
    ends, owners = [], []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        crossing = numpy.nonzero((z[:, a] < 0) != (z[:, b] < 0))[0]
        share = z[crossing, a] / (z[crossing, a] - z[crossing, b])
        start, end = corners[crossing, a, :2], corners[crossing, b, :2]
        ends.append(start + (end - start) * share[:, None])
        owners.append(crossing)
    ends, owners = numpy.concatenate(ends), numpy.concatenate(owners)
    order = numpy.argsort(owners, kind="stable")
    # Each triangle that crosses the plane does so with two of its edges.
    pairs = ends[order].reshape(-1, 2, 2)
    heights = pairs[..., 1]
    return pairs[(heights >= 0).all(axis=1) & (heights > 0).any(axis=1)]


def shadow(section):
    """What the polygons hide, seen from the side: everything between axis and outline."""
    return unary_union([piece for polygon in section for piece in down_to_axis(polygon)])


def down_to_axis(polygon):
    points = polygon + polygon[:1]
    for (za, ra), (zb, rb) in zip(points, points[1:]):
        if za != zb:
            yield Polygon([(za, 0), (za, ra), (zb, rb), (zb, 0)]).buffer(0)


def compare(section, corners, angle):
    """Returns what is wrong with a moment; nothing if all is well."""
    corners = turned(corners, angle)
    outline = unary_union([Polygon(polygon).buffer(0) for polygon in section])
    hidden = shadow(section)
    low, _, high, radius = outline.bounds
    left = low - MARGIN * PIXEL
    columns = math.ceil((high - low) * PIXELS_PER_MM) + 2 * MARGIN
    rows = math.ceil(radius * PIXELS_PER_MM) + MARGIN
    x = left + (numpy.arange(columns) + 0.5) * PIXEL
    y = (numpy.arange(rows) + 0.5) * PIXEL
    grid_x, grid_y = numpy.meshgrid(x, y)
    problems = []
    for name, seen in (("above", corners), ("below", corners * [1, -1, 1])):
        drawn = grid_y <= silhouette(seen, left, columns)
        larger = shapely.contains_xy(hidden.buffer(PIXEL), grid_x, grid_y)
        # Below the axis the other half follows: only the outside shrinks.
        whole = hidden.union(shapely.affinity.scale(hidden, 1, -1, origin=(0, 0)))
        smaller = shapely.contains_xy(whole.buffer(-PIXEL), grid_x, grid_y)
        outside, missing = int((drawn & ~larger).sum()), int((smaller & ~drawn).sum())
        if outside or missing:
            problems.append(f"{name}: {outside} pixels outside, {missing} missing")
    lines = shapely.MultiLineString(list(axis_lines(corners)))
    off_axis = outline.boundary.difference(box(low - 1, -1, high + 1, 1e-3))
    outside = lines.difference(outline.boundary.buffer(PIXEL)).length
    missing = off_axis.difference(lines.buffer(PIXEL)).length
    if outside > 0 or missing > 0:
        problems.append(f"section: {outside:.2f} mm outside, {missing:.2f} mm missing")
    return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="target/release/part_moments")
    parser.add_argument("--moments", type=int, default=200)
    parser.add_argument("--shift", type=float, default=0.0, help="mm by which the drawn part is shifted: the comparison must fail")
    options = parser.parse_args()
    folder = pathlib.Path(__file__).resolve().parents[2] / "assets/programs"
    wrong = 0
    for names in SAMPLES:
        programs = [str(folder / f"{name}.CNC") for name in names]
        job = str(folder / f"{names[0]}.job.ron")
        command = [options.program, job, str(options.moments), *programs]
        moments, failed, areas = 0, 0, set()
        for time, section, corners in read_moments(command):
            problems = compare(section, corners + [options.shift, 0, 0], moments * 0.37)
            areas.add(round(sum(Polygon(it).area for it in section), 3))
            moments += 1
            failed += bool(problems)
            for problem in problems:
                print(f"{names[0]}, {time:.2f} s, {problem}")
        if moments != options.moments:
            sys.exit(f"{names[0]}: {moments} moments instead of {options.moments}")
        print(f"{names[0]}: {moments} moments, {len(areas)} different parts, {failed} wrong")
        wrong += failed
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
