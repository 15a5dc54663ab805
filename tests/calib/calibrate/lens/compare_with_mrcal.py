"""Compares a calibration of ours with mrcal's Python; prints name and number, a line each.

The folder holds corners.vnl, ours.cameramodel, fit.json (our poses, as rows, and the bend of the board)
and uncertainty.txt (pixel x, y, our worst sigma at infinity and at 500).
At "optimum", mrcal's uncertainty is that of our own solution; by "tool", that of the solution which
mrcal-calibrate-cameras finds for the same corners, and the difference of the projections is printed.

Usage: compare_with_mrcal.py optimum|tool FOLDER LENSMODEL FOCAL SPACING COLUMNS ROWS WIDTH HEIGHT"""

import json
import subprocess
import sys

import mrcal
import numpy as np

how, folder, lens, focal, spacing, columns, rows, width, height = sys.argv[1:]
ours = mrcal.cameramodel(folder + "/ours.cameramodel")


def by_tool():
    # Its seeds are random, and about one of six ends in a worse minimum: here they are always the same.
    # Its outliers depend on the seeds; these corners have none.
    run = ("import numpy, runpy, sys; numpy.random.seed(1); "
           "runpy.run_path(sys.argv[0], run_name='__main__')")
    tool = subprocess.check_output(["which", "mrcal-calibrate-cameras"], text=True).strip()
    subprocess.run([sys.executable, "-c", "import sys; sys.argv = sys.argv[1:]; " + run, tool,
                    "--corners-cache", folder + "/corners.vnl",
                    "--lensmodel", lens, "--focal", focal, "--object-spacing", spacing,
                    "--object-width-n", columns, "--object-height-n", rows,
                    "--imagersize", width, height, "--outdir", folder,
                    "--skip-outlier-rejection", "p*.png"],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return mrcal.cameramodel(folder + "/camera-0.cameramodel")


def at_optimum():
    with open(folder + "/fit.json") as file:
        fit = json.load(file)
    poses = np.array(fit["poses"])
    Rt = np.concatenate([poses[:, :, :3], poses[:, None, :, 3]], axis=1)
    lines = [line.split()[1:3] for line in open(folder + "/corners.vnl") if line[0] != "#"]
    seen = np.array([[-1, -1, -1] if x == "-" else [float(x), float(y), 1] for x, y in lines], float)
    count = len(poses)
    inputs = dict(
        intrinsics=ours.intrinsics()[1].reshape(1, -1), lensmodel=lens,
        extrinsics_rt_fromref=np.zeros((0, 6)), frames_rt_toref=mrcal.rt_from_Rt(Rt), points=None,
        observations_board=seen.reshape(count, int(rows), int(columns), 3),
        indices_frame_camintrinsics_camextrinsics=np.array(
            [[i, 0, -1] for i in range(count)], dtype=np.int32),
        observations_point=None, indices_point_camintrinsics_camextrinsics=None,
        imagersizes=np.array([[int(width), int(height)]], dtype=np.int32),
        calobject_warp=np.array(fit["warp"]), do_optimize_intrinsics_core="SPLINED" not in lens,
        do_optimize_intrinsics_distortions=True, do_optimize_extrinsics=True,
        do_optimize_frames=True, do_optimize_calobject_warp=True, do_apply_regularization=True,
        do_apply_outlier_rejection=False, calibration_object_spacing=float(spacing), verbose=False)
    return mrcal.cameramodel(optimization_inputs=inputs, icam_intrinsics=0)


theirs = by_tool() if how == "tool" else at_optimum()
given = np.loadtxt(folder + "/uncertainty.txt")
v = mrcal.unproject(given[:, :2], *theirs.intrinsics(), normalize=True)
far = mrcal.projection_uncertainty(v, theirs, atinfinity=True, what="worstdirection-stdev")
near = mrcal.projection_uncertainty(500 * v, theirs, what="worstdirection-stdev")
print("difference_px", np.max(mrcal.projection_diff((theirs, ours), intrinsics_only=True)[0]))
print("worst_ratio_far", np.max(np.abs(given[:, 2] / far - 1)))
print("worst_ratio_near", np.max(np.abs(given[:, 3] / near - 1)))
for value in ours.intrinsics()[1]:
    print("intrinsic", repr(float(value)))
