# Calibrates and diagnoses a capture, then says where the flange really goes.
import numpy as np
import poecal

run = poecal.runCapture("capture", "out")  # writes what `poecal run` does, but for the page
for finding in run.calibration.diagnosis.findings:
    print(finding.effect, "at", finding.location, dict(finding.parameters), f"probability {finding.probability:.3f}")

arm = poecal.realArm(poecal.readModel("out/model.yaml"))
q = np.zeros((3, 6))  # N x n joint readings [rad]
q[:, 1] = [-0.2, 0.0, 0.2]
T_base_flange = poecal.reachedPoses(arm, poecal.sampleTable(q=q))  # N x 4 x 4, effects included
print(T_base_flange[:, :3, 3] - poecal.forwardKinematics(arm.arm, q)[:, :3, 3])  # what the effects do [m]
print(poecal.read_results("out").shrinkage)
