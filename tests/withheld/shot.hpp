// One row of samples.csv, and which columns a capture has.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace withheld {

struct Shot {
  std::string image;
  Eigen::VectorXd q, dir, dq;  ///< dq in rad/s or m/s
  int pose = 0;
  double stamp = 0.0;        ///< [s]
  double hours = 0.0;        ///< since the first shot
  double temperature = 0.0;  ///< [degrees Celsius]
  double kelvin = 0.0;       ///< above the first shot's temperature
  double payload = 0.0;      ///< [kg]
};

struct Columns {
  bool pose = false, stamp = true, dir = true, dq = false, temperature = false, payload = false;
  bool still_dq = false;  ///< dq is written though the arm stood still: zeros
};

}  // namespace withheld
