"""Calibrates a capture and plots what it gave, cell by cell: python3 example.py CAPTURE OUT. A capture to try it with:

poecal simulate calib_data/cobot6/scene-joint.yaml --out capture
"""
# %% The main job: what `poecal run CAPTURE --out OUT` does
import sys
from pathlib import Path

import numpy as np
import poecal

capture, out = Path(sys.argv[1]), Path(sys.argv[2])
run = poecal.runCapture(capture, out, poecal.CalibrateOptions(jobs=0))
calibration = run.calibration

# %% The verdict
identification, diagnosis, model = calibration.identification, calibration.diagnosis, calibration.model
if identification is None or model is None:
    sys.exit("the arm was not identified: the capture has no joint readings")
if diagnosis is None:
    sys.exit(f"no diagnosis: {calibration.no_diagnosis}")
print(poecal.diagnosisText(diagnosis, run.measurements.samples))

# %% Where the flange really goes, effects included, beside what the nominal arm says
q = np.array([sample.q for sample in run.measurements.samples])
nominal = poecal.forwardKinematics(identification.nominal, q)
table = poecal.SampleTable(samples=run.measurements.samples, other_columns=run.measurements.other_columns)
real = poecal.reachedPoses(poecal.realArm(model), table)
shift = 1e3 * np.linalg.norm(real[:, :3, 3] - nominal[:, :3, 3], axis=1)
print(f"the flange is {shift.mean():.3f} mm from where the nominal arm says, at most {shift.max():.3f} mm")

# %% The ladder of model stages, on poses that the fit did not see
unit, scale = ("px", 1.0) if diagnosis.pixels else ("mm", 1e3)
names = [stage.stage for stage in diagnosis.stages]
rms = scale * np.array([stage.rms for stage in diagnosis.stages])
bounds = scale * np.array([stage.rms_interval for stage in diagnosis.stages])
for name, value, (low, high) in zip(names, rms, bounds):
    print(f"{name:40} {value:.3f} {unit} ({low:.3f} to {high:.3f})")

try:
    import matplotlib
except ImportError:
    sys.exit("no plots: matplotlib is not installed (Debian's python3-matplotlib)")
matplotlib.use("Agg")
from matplotlib import pyplot, ticker

figure, axes = pyplot.subplots(figsize=(8, 3), layout="constrained")
axes.errorbar(rms, names, xerr=[np.maximum(rms - bounds[:, 0], 0.0), np.maximum(bounds[:, 1] - rms, 0.0)], fmt="o", capsize=3)
if diagnosis.noiseKnown():
    axes.axvline(scale * diagnosis.noise_rms, linestyle="--", color="grey", label="noise")
    axes.legend()
axes.set_xscale("log")
axes.xaxis.set_major_locator(ticker.LogLocator(subs=(1.0, 2.0, 5.0)))
axes.xaxis.set_major_formatter("{x:g}")
axes.xaxis.set_minor_locator(ticker.NullLocator())
axes.set_xlabel(f"error on held-out poses, rms [{unit}]")
axes.invert_yaxis()
figure.savefig(out / "ladder.png", dpi=150)

# %% The residuals of the identified arm, picture by picture
rows = identification.stages[-1].held_out_rows
largest = scale * np.array([row.lengths.max() for row in rows])
figure, axes = pyplot.subplots(figsize=(8, 3), layout="constrained")
axes.plot([row.index for row in rows], largest, ".")
axes.set_xlabel("number of the picture")
axes.set_ylabel(f"largest residual [{unit}]")
figure.savefig(out / "residuals.png", dpi=150)
print(f"plots: {out / 'ladder.png'}, {out / 'residuals.png'}")
