"""Calibrates the corners of a folder by the mrcal-calibrate-cameras tool, and prints how far the
lens ours.cameramodel is from it and our uncertainties (uncertainty.txt: pixel x, y, worst sigma at
infinity, worst sigma at 500) from mrcal's: name and number, a line each.

Usage: compare_with_mrcal.py FOLDER LENSMODEL FOCAL SPACING COLUMNS ROWS WIDTH HEIGHT"""

import subprocess
import sys

import mrcal
import numpy as np

folder, lens, focal, spacing, columns, rows, width, height = sys.argv[1:]
subprocess.run(["mrcal-calibrate-cameras", "--corners-cache", folder + "/corners.vnl",
                "--lensmodel", lens, "--focal", focal, "--object-spacing", spacing,
                "--object-width-n", columns, "--object-height-n", rows,
                "--imagersize", width, height, "--outdir", folder, "p*.png"],
               check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
theirs = mrcal.cameramodel(folder + "/camera-0.cameramodel")
ours = mrcal.cameramodel(folder + "/ours.cameramodel")
given = np.loadtxt(folder + "/uncertainty.txt")
v = mrcal.unproject(given[:, :2], *theirs.intrinsics(), normalize=True)
far = mrcal.projection_uncertainty(v, theirs, atinfinity=True, what="worstdirection-stdev")
near = mrcal.projection_uncertainty(500 * v, theirs, what="worstdirection-stdev")
again = mrcal.project(v, *ours.intrinsics())
print("difference_px", np.max(mrcal.projection_diff((theirs, ours), intrinsics_only=True)[0]))
print("worst_ratio_far", np.max(np.abs(given[:, 2] / far - 1)))
print("worst_ratio_near", np.max(np.abs(given[:, 3] / near - 1)))
for value in ours.intrinsics()[1]:
    print("intrinsic", repr(float(value)))
