"""Draws a thin section for [[map]] with grains = true: cells of random points, each a grain of one of three minerals.

    draw_micrograph.py micrograph.png [--seed 1] [--grains 70] [--size 200 100]

Grains of one mineral that touch have different shades of its colour, so that each is a patch of one colour. Needs numpy
and Pillow (Debian: python3-numpy, python3-pil).
"""
import argparse

import numpy as np
from PIL import Image

MINERALS = {"quartz": (0.35, (200, 200, 205)), "feldspar": (0.5, (225, 170, 140)), "mica": (0.15, (70, 60, 60))}
SHADES = 7  # more than a planar map needs, as the greedy choice is not the best one


def cells(points, width, height):
    y, x = np.mgrid[0:height, 0:width]
    far = (x[..., None] + 0.5 - points[:, 0]) ** 2 + (y[..., None] + 0.5 - points[:, 1]) ** 2
    return far.argmin(axis=2)


def draw(seed=1, grains=70, width=200, height=100):
    random = np.random.default_rng(seed)
    points = random.uniform((0, 0), (width, height), (grains, 2))
    for _ in range(3):  # rounder cells: points move to the centres of their pixels
        label = cells(points, width, height)
        y, x = np.mgrid[0:height, 0:width]
        points = np.stack([[c[label == i].mean() + 0.5 for c in (x, y)] for i in range(grains)])
    label = cells(points, width, height)
    mineral = random.choice(len(MINERALS), grains, p=[part for part, _ in MINERALS.values()])
    touching = [set() for _ in range(grains)]
    for a, b in ((label[:, 1:], label[:, :-1]), (label[1:], label[:-1])):
        for i, j in {(i, j) for i, j in zip(a[a != b], b[a != b])}:
            touching[i].add(j), touching[j].add(i)
    shade = np.full(grains, -1)
    for i in range(grains):
        shade[i] = min(set(range(SHADES)) - {shade[j] for j in touching[i] if mineral[j] == mineral[i]})
    base = np.array([colour for _, colour in MINERALS.values()])
    return np.uint8(base[mineral] + 6 * shade[:, None] - 18)[label]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("target")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--grains", type=int, default=70)
    parser.add_argument("--size", type=int, nargs=2, default=(200, 100))
    options = parser.parse_args()
    Image.fromarray(draw(options.seed, options.grains, *options.size)).quantize(256).save(options.target, optimize=True)
