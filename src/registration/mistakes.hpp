// What people get wrong in a capture, each as the transformation of the input that puts it right.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "poecal/registration/implausible.hpp"
#include "registration/problem.hpp"

namespace poecal {

struct Mistake {
  std::string text;  ///< "q3 counts the other way"
  InputPart part = InputPart::kSamples;
  std::function<void(Problem&)> undo;
  bool sure = true;  ///< other explanations of its kind are as simple; false: it takes two changes and yields to one that takes one
};

// Of two mistakes that explain a capture, by what each leaves: one that stands before the other, and one that is told beside it.
constexpr double kClearlyBetter = 0.7;
constexpr double kAsGood = 1.1;

/// "; as likely: TEXT", of another mistake that explains as much; empty where there is none.
inline std::string asLikely(const std::string& other) { return other.empty() ? "" : "; as likely: " + other; }

/// Of joint readings: units, signs, exchanged columns, zeros. None without an arm.
std::vector<Mistake> jointMistakes(const Problem& problem);
/// Two of them at once: exchanged columns and signs, signs and zeros, zeros of two joints. Some six hundred for six joints.
std::vector<Mistake> jointMistakePairs(const Problem& problem);
/// Of poses, those of the flange where there is no arm, or those of an instrument: units, quaternions, Euler angles, inverses.
std::vector<Mistake> poseMistakes(const Problem& problem);
/// Poses of the flange that are inverted, of some rows beside others: a whole capture of them is one of the other setup.
std::vector<Mistake> inversions(const Problem& problem);
/// The other setup; for pictures only.
std::vector<Mistake> setupMistakes(const Problem& problem);
/// Order of the rows as a whole: turned round, or by name as text where the other is by number; and one joint a row late or early.
std::vector<Mistake> orderMistakes(const Problem& problem, const std::vector<Observation>& all);
/// Sizes in other units: target, robot.
std::vector<Mistake> unitMistakes(const Problem& problem);
/// The corners are those of pictures of another resolution than the camera's figures.
std::vector<Mistake> resolutionMistakes(const Problem& problem);
/// Likewise, or the pictures are cut out.
std::vector<Mistake> lensMistakes(const Problem& problem);
/// Pictures that are turned or mirrored, a board that is read from its other end or a row late: of some rows beside others, since a whole
/// capture that is turned is one of a camera or a board that is.
std::vector<Mistake> pictureMistakes(const Problem& problem);
/// Corners of every tag in another order. Only where the corners do not even fit with poses of their own.
std::vector<Mistake> cornerMistakes(const Problem& problem);
/// Tags of a board numbered in another order, or closer or farther apart. Likewise.
std::vector<Mistake> layoutMistakes(const Problem& problem, const std::vector<Observation>& all);
/// Points of a target that lists them: two exchanged, all mirrored, or one of them elsewhere. None for other targets. Likewise.
std::vector<Mistake> pointMistakes(const Problem& problem, const std::vector<Observation>& all);

}  // namespace poecal
