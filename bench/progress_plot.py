#!/usr/bin/env python3
"""How the estimates of runs on a simulated rig get better as keyframes come: prints a table of the
errors against the truth and of the stated sigma_total, and draws both as SVG.

  turnlight run configs/simulated_orbit.yaml --out simulated_orbit
  turnlight run configs/simulated_turntable.yaml --out simulated_turntable
  bench/progress_plot.py --svg docs/progress.svg simulated_orbit simulated_turntable

Usage: bench/progress_plot.py [--svg FILE] RUN...
"""
import csv
import json
import math
import os
import sys

WIDTH, HEIGHT, MARGIN = 380, 240, 56
COLOURS = ["#1b6ca8", "#c8553d", "#3a7d44", "#7d5ba6"]


def curves(run):
    """Per light: keyframes, direction error and sigma (deg), distance error and sigma (%; None if
    the light is infinitely far)."""
    with open(os.path.join(run, "session", "truth.json")) as file:
        truth = json.load(file)["lights"]
    lights = [[] for _ in truth]
    with open(os.path.join(run, "result", "progress.csv")) as file:
        for row in csv.DictReader(file):
            found = [float(row["direction_" + axis]) for axis in "xyz"]
            cosines = [sum(a * b for a, b in zip(found, light["direction"])) for light in truth]
            nearest = max(range(len(truth)), key=cosines.__getitem__)
            true_rho = truth[nearest]["inverse_distance"]
            lights[nearest].append((
                int(row["keyframes"]),
                math.degrees(math.acos(min(1.0, cosines[nearest]))),
                float(row["direction_sigma_deg"]),
                100 * abs(float(row["inverse_distance"]) / true_rho - 1) if true_rho else None,
                100 * float(row["inverse_distance_sigma"]) / true_rho if true_rho else None))
    return lights


def panel(title, unit, lights, column, left, top):
    """Error in `column`, sigma in the next; logarithmic upwards."""
    lights = [[point for point in light if point[column] is not None] for light in lights]
    values = [point[c] for light in lights for point in light for c in (column, column + 1)]
    if not values:
        return [f'<text x="{left + MARGIN}" y="{top + 18}">{title}: no light has one</text>']
    low = math.floor(math.log10(max(min(values), 1e-5)))
    high = math.ceil(math.log10(max(values)))
    last = max(point[0] for light in lights for point in light)

    def place(keyframes, value):
        share = (math.log10(max(value, 10.0**low)) - low) / (high - low)
        return (left + MARGIN + keyframes / last * (WIDTH - MARGIN - 12),
                top + HEIGHT - 40 - share * (HEIGHT - 70))

    svg = [f'<text x="{left + MARGIN}" y="{top + 18}" font-weight="bold">{title}</text>']
    for power in range(low, high + 1):
        (x0, y), (x1, _) = place(0, 10.0**power), place(last, 10.0**power)
        svg.append(f'<path d="M{x0:.1f} {y:.1f}H{x1:.1f}" stroke="#ddd"/>'
                   f'<text x="{x0 - 6:.1f}" y="{y + 4:.1f}" text-anchor="end">'
                   f'{10.0**power:g} {unit}</text>')
    for tick in range(0, last + 1, 6):
        x, y = place(tick, 10.0**low)
        svg.append(f'<text x="{x:.1f}" y="{y + 16:.1f}" text-anchor="middle">{tick}</text>')
    for number, light in enumerate(lights):
        for c, dash in ((column, ""), (column + 1, ' stroke-dasharray="5 4"')):
            points = " ".join("%.1f,%.1f" % place(p[0], p[c]) for p in light)
            svg.append(f'<polyline points="{points}" fill="none" stroke-width="1.6" '
                       f'stroke="{COLOURS[number % len(COLOURS)]}"{dash}/>')
    return svg


def measure(error, sigma, unit):
    """An error in its unit and in sigmas."""
    if error is None:
        return "infinitely far"
    return f"{error:.2g}{unit} ({error / sigma:.1f} sigma)" if sigma > 0 else f"{error:.2g}{unit}"


def table(runs):
    """Markdown: of every light the last estimate, and the largest error on the way in sigmas."""
    rows = ["| run | light | keyframes | direction | distance | largest on the way |",
            "|---|---|---|---|---|---|"]
    for run in runs:
        for number, light in enumerate(curves(run), 1):
            name = os.path.basename(os.path.normpath(run))
            if not light:
                rows.append(f"| `{name}` | {number} | | not found | | |")
                continue
            last = light[-1]
            worst = max(point[c] / point[c + 1] for point in light for c in (1, 3)
                        if point[c] is not None and point[c + 1] > 0)
            rows.append(f"| `{name}` | {number} | {last[0]} | {measure(last[1], last[2], '°')} | "
                        f"{measure(last[3], last[4], ' %')} | {worst:.1f} sigma |")
    return "\n".join(rows)


def draw(out, runs):
    svg = []
    for row, run in enumerate(runs):
        lights = curves(run)
        name = os.path.basename(os.path.normpath(run))
        svg += panel(f"{name}: direction", "°", lights, 1, 0, row * HEIGHT)
        svg += panel(f"{name}: distance", "%", lights, 3, WIDTH, row * HEIGHT)
    height = len(runs) * HEIGHT + 24
    svg.append(f'<text x="{MARGIN}" y="{height - 8}">keyframes; error solid, sigma_total dashed, '
               'a colour per light</text>')
    with open(out, "w") as file:
        file.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * WIDTH}" height="{height}" '
                   'font-family="sans-serif" font-size="11">'
                   f'<rect width="100%" height="100%" fill="white"/>' + "\n".join(svg) + "</svg>\n")


def main(arguments):
    out = None
    if len(arguments) > 1 and arguments[0] == "--svg":
        out, arguments = arguments[1], arguments[2:]
    if not arguments or arguments[0].startswith("-"):
        sys.exit(__doc__)
    print(table(arguments))
    if out:
        draw(out, arguments)


if __name__ == "__main__":
    main(sys.argv[1:])
