#!/usr/bin/python3
"""Lights over a glossy sphere from the centroids of its highlights: the script that one writes first.

Usage: bench/peers/highlight_centroids.py SESSION      prints {"lights": [{"direction": [x, y, z]}, ...]}

Directions are from the sphere's centre, in the session's world frame; blobs of one direction in several
frames are one light. For spheres, pinhole cameras, and linear pictures of one exposure. See README.md."""
import ast
import json
import pathlib
import sys

import cv2
import numpy as np

BLOB = 0.15      # a highlight is narrower than this, in radii of the disc,
CONTRAST = 0.5   # brighter than its surroundings by this share of them
FLOOR = 0.05     # and by this share of white; the sensor's noise is far below
SAME_DEG = 5.0   # blobs whose lights are nearer to each other are one light


def mirrored(session, lens, frame, pixels):
    """The directions that the sphere mirrors into pixels (..., 2), and where it is met at all."""
    X_WC, X_WT = np.array(frame["X_WC"]), np.array(frame["X_WT"])
    rays = np.concatenate([(pixels - lens[2:4]) / lens[:2], np.ones_like(pixels[..., :1])], -1) @ X_WC[:, :3].T
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    from_centre = X_WC[:, 3] - X_WT[:, 3]
    along = rays @ from_centre
    root = along**2 - from_centre @ from_centre + session["target"]["radius"] ** 2
    normals = from_centre - (along + np.sqrt(np.maximum(root, 0.0)))[..., None] * rays
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return rays - 2.0 * np.sum(rays * normals, -1, keepdims=True) * normals, root > 0.0


def spots_of(grey, disc):
    """By how much pixels are brighter than what is around; 0 where that is no highlight."""
    width = 2 * round(BLOB * np.sqrt(disc.sum() / np.pi)) + 1
    around = cv2.morphologyEx(grey, cv2.MORPH_OPEN, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (width, width)))
    spots = cv2.GaussianBlur(grey, (0, 0), 1.0) - around
    inside = cv2.erode(np.pad(disc.astype(np.uint8), 1), np.ones((7, 7)))[1:-1, 1:-1] > 0
    return np.where(inside & (spots > CONTRAST * around + FLOOR), spots, 0.0)


def main(folder):
    session = json.loads((folder / "session.json").read_text())
    lens = np.array(ast.literal_eval((folder / session["camera"]).read_text())["intrinsics"])
    black, white = (session["radiometry"][key] for key in ("black", "white"))
    clusters = []  # for each light the directions of its blobs
    for frame in session["frames"]:
        image = cv2.imread(str(folder / frame["image"]), cv2.IMREAD_UNCHANGED).astype(np.float32)
        grey = (image.reshape(*image.shape[:2], -1).mean(-1) - black) / (white - black)
        rows, columns = np.indices(grey.shape)
        spots = spots_of(grey, mirrored(session, lens, frame, np.stack([columns, rows], -1) * 1.0)[1])
        count, labels = cv2.connectedComponents((spots > 0.0).astype(np.uint8))
        for weights in (np.where(labels == label, spots, 0.0) for label in range(1, count)):
            centroid = np.array([(weights * columns).sum(), (weights * rows).sum()]) / weights.sum()
            direction = mirrored(session, lens, frame, centroid)[0]
            near = [c for c in clusters if np.mean(c, 0) @ direction > np.cos(np.radians(SAME_DEG))]
            if near:
                near[0].append(direction)
            else:
                clusters.append([direction])
    means = [np.mean(c, 0) for c in clusters if 4 * len(c) >= len(session["frames"])]
    print(json.dumps({"lights": [{"direction": (m / np.linalg.norm(m)).tolist()} for m in means]}))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
