// The files of a calibration: each format is written and read here, and nowhere else.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "poecal/calibration/calibrate.hpp"

namespace poecal {

/// Text of registration.yaml (format poecal-registration/1). @throws InvalidArgument where nothing was registered.
std::string registrationYaml(const Calibration& calibration, const Measurements& measurements);

/// Text of flange_poses.csv: the flange poses that the camera measured, with every column of samples.csv that is not the controller's own
/// pose. `identify --poses FILE --registered` and `diagnose` read it: the pose, its deviations and, behind them, its covariance `covIJ` of
/// (log of the left rotation error in base; position) [rad; m].
std::string flangePosesCsv(const Calibration& calibration, const Measurements& measurements);

/// Text of diagnosis.json, whether there was a diagnosis or not. @throws InvalidArgument where none was asked for.
std::string diagnosisJson(const Calibration& calibration, const Measurements& measurements);

/// Which files to write.
struct ResultFiles {
  bool registration = false;    ///< registration.yaml, flange_poses.csv; where corners were measured
  bool identification = false;  ///< identification.json, model.yaml
  bool diagnosis = false;       ///< diagnosis.json, model.yaml
};
/// Writes what the calibration holds of these files into `out`, each file once. @throws FileError where one cannot be written.
void writeResults(const Calibration& calibration, const Measurements& measurements, const ResultFiles& files,
                  const std::filesystem::path& out);

/// Errors of one model stage on held-out poses, as identification.json and diagnosis.json have them.
struct StageErrors {
  std::string stage;
  std::optional<double> rms_px;    ///< unset for poses of an instrument
  std::optional<double> position;  ///< at the flange, mean [mm]
  std::optional<double> rotation;  ///< mean [mrad]
};

/// One finding of diagnosis.json in a few words.
struct FindingSummary {
  std::string effect, location;
  std::string size;  ///< "half_gap 0.0003 rad, source 5"
  std::string driver = {};
  double probability = 0.0;                         ///< among the alternatives
  std::vector<AlternativeCause> alternatives = {};  ///< that the data leave open
  std::string separate_with = {};                   ///< what would tell them apart
};

/// What registration.yaml, identification.json and diagnosis.json of a folder say in short.
struct ResultSummary {
  std::filesystem::path folder;
  std::string name;  ///< of the folder
  std::optional<long> pictures, pictures_with_corners, pictures_left_out;
  std::optional<double> registration_px, free_pose_px;
  std::optional<long> poses;
  std::vector<StageErrors> stages;     ///< nominal, registered, identified; empty where none was held out
  std::optional<std::string> verdict;  ///< of the diagnosis; unset where there is none
  std::string why;                     ///< where the data are insufficient for a diagnosis
  std::vector<FindingSummary> findings;
  bool structure_left = false;  ///< that no finding explains
  bool gap_remains = false;     ///< likewise; see Diagnosis::gap_remains
  std::optional<StageErrors> diagnosed;
  std::optional<double> shrinkage, shrinkage_low, shrinkage_high;  ///< unset where none is claimed
  std::optional<long> bad_samples;
  std::vector<std::string> warnings;
  std::vector<std::string> bad_images;         ///< of the diagnosis' bad_samples
  std::optional<double> noise_scale;           ///< of the identification: factor on the corners' stated deviations
  std::optional<double> corner_sigma_px;       ///< of the diagnosis, or where it gave none of the identification
  std::optional<double> tag_sigma_px;          ///< of the diagnosis [px]
  std::optional<double> joint_repeatability;   ///< of the diagnosis [rad]
  std::optional<double> arm_beyond_tolerance;  ///< likewise

  /// Whether something is left that no finding explains, of either kind.
  bool isUnexplained() const { return structure_left || gap_remains; }

  /// The errors of a stage; nothing where it is not there.
  const StageErrors* stage(const std::string& stage) const;
};

/// Reads the results in a folder; none of the files need be there. @throws FileError where there is no such folder, or with file and line
/// where one of the files is not what its step writes.
ResultSummary readResults(const std::filesystem::path& folder);

}  // namespace poecal
