# Calibrates and diagnoses a capture, then says how far the flange is from where the nominal arm has it.
import numpy as np
import poecal

run = poecal.runCapture("capture", "out")  # writes what `poecal run` writes, but for the page
for finding in run.calibration.diagnosis.findings:
    print(finding.effect, "at", finding.location, dict(finding.parameters), f"probability {finding.probability:.3f}")
print(f"the gap shrinks by {poecal.read_results('out').shrinkage:.0%}")

q = np.array([sample.q for sample in run.measurements.samples])  # N x n joint readings [rad]
arm = poecal.realArm(poecal.readModel("out/model.yaml"))
real = poecal.reachedPoses(arm, poecal.sampleTable(q))  # N x 4 x 4: T_base_flange, effects included
nominal = poecal.forwardKinematics(run.calibration.identification.nominal, q)
print("mean distance", 1e3 * np.linalg.norm(real[:, :3, 3] - nominal[:, :3, 3], axis=1).mean(), "mm")
