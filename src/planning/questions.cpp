#include "planning/questions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "diagnosis/evidence.hpp"
#include "poecal/core/choices.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

/// The rows that poses would add to a contrast.
std::vector<WhiteRows> rowsOf(const AskedContrast& asked, const std::vector<WhiteRows>& expected) {
  std::vector<WhiteRows> all;
  all.reserve(expected.size());
  for (const WhiteRows& rows : expected) {
    WhiteRows some(rows.rows(), asked.base + asked.own_size + 1);
    some << rows.leftCols(asked.base), rows.middleCols(asked.own_begin, asked.own_size), rows.leftCols(asked.mean.size()) * asked.mean;
    all.push_back(condensed(std::move(some)));
  }
  return all;
}

/// Columns [begin, begin + size) of rows.
struct Span {
  Eigen::Index begin = 0, size = 0;
};

/// Where each explanation's columns stand behind those of the base model.
std::vector<Span> spansOf(Eigen::Index base, const std::vector<FurtherColumns>& explanations) {
  std::vector<Span> spans;
  for (const FurtherColumns& explanation : explanations) {
    spans.push_back({base, explanation.sigma.size()});
    base += explanation.sigma.size();
  }
  return spans;
}

Eigen::Index baseColumns(const Knowledge& knowledge, const std::vector<FurtherColumns>& explanations) {
  Eigen::Index further = 0;
  for (const FurtherColumns& explanation : explanations) further += explanation.sigma.size();
  return knowledge.columns() - further;
}

bool isOf(const Rival& rival, const std::string& effect, const std::string& location, const std::string& driver) {
  return rival.effect == effect && rival.location == location && rival.driver == driver;
}

/// Takes the effect that a finding names out of a model's. @return it, where it is among them.
std::optional<AppliedEffect> takeOut(const Rival& finding, std::vector<AppliedEffect>& effects) {
  const auto found = std::find_if(effects.begin(), effects.end(), [&finding](const AppliedEffect& applied) {
    return isOf(finding, applied.effect.name(), applied.effect.location(), applied.effect.driver().name());
  });
  if (found == effects.end()) return {};
  AppliedEffect effect = *found;
  effects.erase(found);
  return effect;
}

/// Of all instances of a rival, the one that the data so far speak for most, as wide as fits best.
std::optional<FurtherColumns> bestInstance(const PlanningCell& cell, const std::vector<AppliedEffect>& effects,
                                           const std::vector<Candidate>& instances) {
  if (instances.empty()) return {};
  std::vector<FurtherColumns> all;
  for (const Candidate& instance : instances) all.push_back({instance, instance.typical});
  const Knowledge knowledge(cell, effects, all);
  const Eigen::Index base = baseColumns(knowledge, all);
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(knowledge.columns() + 1, knowledge.columns() + 1);
  for (const WhiteRows& rows : knowledge.taken()) squares += rows.transpose() * rows;
  const ColumnPrior prior = knowledge.prior();
  const Eigen::MatrixXd Sigma = covarianceOf(squares.topLeftCorner(base, base) + prior.precision.topLeftCorner(base, base));
  const Eigen::VectorXd score = squares.topRightCorner(base, 1) - prior.precision.topLeftCorner(base, base) * prior.offset.head(base);
  std::optional<FurtherColumns> best;
  double most = 0.0;
  const std::vector<Span> spans = spansOf(base, all);
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const Eigen::MatrixXd cross = squares.block(0, spans[i].begin, base, spans[i].size);
    const Eigen::MatrixXd S =
        squares.block(spans[i].begin, spans[i].begin, spans[i].size, spans[i].size) - cross.transpose() * Sigma * cross;
    const Eigen::VectorXd u = squares.block(spans[i].begin, squares.cols() - 1, spans[i].size, 1) - cross.transpose() * (Sigma * score);
    const Evidence evidence = evidenceOf(S, u, instances[i]);
    const double weight = evidence.log_bayes + instances[i].log_prior;
    if (best && weight <= most) continue;
    most = weight;
    Accepted accepted{.candidate = instances[i], .factors = Eigen::VectorXd::Zero(spans[i].size), .scale = evidence.scale};
    if (evidence.found.size() > 0) accepted.factors.head(evidence.found.size()) = evidence.found;
    best = FurtherColumns{instances[i], fittedSpread(accepted)};
  }
  return best;
}

std::string nameOf(const Rival& rival) { return fmt::format("{}@{}/{}", rival.effect, rival.location, rival.driver); }

/// One finding's explanations with their columns, and the model without that finding.
struct Explanations {
  std::vector<AppliedEffect> effects;
  std::vector<Rival> rivals;
  std::vector<FurtherColumns> columns;  ///< one for each rival
};

Explanations explanationsOf(const PlanningCell& cell, const Rivals& rivals, const ProgressFunction& progress,
                            std::vector<std::string>& not_told) {
  Progress told(progress, "what the data say of each explanation", rivals.explanations.size());
  told.show();
  Explanations all{.effects = cell.model.effects, .rivals = {}, .columns = {}};
  const std::optional<AppliedEffect> found = takeOut(rivals.explanations.front(), all.effects);
  const Knowledge without(cell, all.effects);
  const std::vector<Candidate> candidates = allCandidates(without.measured(), without.state()).candidates;
  for (const Rival& rival : rivals.explanations) {
    std::vector<Candidate> instances;
    if (found && &rival == &rivals.explanations.front()) {
      instances.push_back(modelCandidate(*found));
    } else {
      std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(instances), [&rival](const Candidate& candidate) {
        return isOf(rival, candidate.name, candidate.place.name(), candidate.driver.name());
      });
    }
    const std::optional<FurtherColumns> best = bestInstance(cell, all.effects, instances);
    if (best) {
      all.rivals.push_back(rival);
      all.columns.push_back(*best);
    } else if (rival.effect == "joint_scatter") {
      not_told.push_back(nameOf(rival) + ": take some poses again; a joint that moves at random does not come back to the same place");
    } else {
      not_told.push_back(nameOf(rival) + ": this capture has no column for it");
    }
    told.advance();
  }
  return all;
}

/// What the data so far make of one explanation.
struct Fitted {
  Eigen::MatrixXd information;
  Eigen::VectorXd b;
};

Fitted fitted(const std::vector<WhiteRows>& taken, const ColumnPrior& prior, Eigen::Index base, const Span& own) {
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(base + own.size));
  std::iota(columns.begin(), columns.begin() + base, 0);
  std::iota(columns.begin() + base, columns.end(), own.begin);
  Fitted fit{prior.precision(columns, columns), Eigen::VectorXd()};
  Eigen::VectorXd g = -fit.information * prior.offset(columns);
  for (const WhiteRows& rows : taken) {
    const Eigen::MatrixXd X = rows(Eigen::all, columns);
    fit.information += X.transpose() * X;
    g += X.transpose() * rows.col(rows.cols() - 1);
  }
  fit.b = covarianceOf(fit.information) * g;
  return fit;
}

/// The contrast of two explanations: rows that the right one makes, in the model of the wrong one.
AskedContrast contrastOf(const std::shared_ptr<const Knowledge>& knowledge, Eigen::Index base, const Fitted& right,
                         const Span& right_columns, const Fitted& wrong, const Span& wrong_columns) {
  AskedContrast asked{.knowledge = knowledge,
                      .before = {.information = wrong.information, .v = Eigen::VectorXd::Zero(wrong.b.size())},
                      .base = base,
                      .own_begin = wrong_columns.begin,
                      .own_size = wrong_columns.size,
                      .mean = Eigen::VectorXd::Zero(knowledge->columns())};
  asked.mean.head(base) = right.b.head(base) - wrong.b.head(base);
  asked.mean.segment(right_columns.begin, right_columns.size) += right.b.tail(right_columns.size);
  asked.mean.segment(wrong_columns.begin, wrong_columns.size) -= wrong.b.tail(wrong_columns.size);
  return asked;
}

/// What all poses together would add to a contrast.
double mostChiSquare(const AskedContrast& asked, const std::vector<WhiteRows>& expected) {
  const std::vector<WhiteRows> rows = rowsOf(asked, expected);
  Contrast contrast = asked.before;
  for (const WhiteRows& pose : rows) contrast.add(pose, 1.0);
  return contrast.s - contrast.v.dot(covarianceOf(contrast.information) * contrast.v);
}

/// Adds the contrasts of one finding.
void addContrasts(const PlanningCell& cell, const Explanations& all, const std::vector<Sample>& candidates, const PlanOptions& options,
                  const std::string& separate_with, Question& question) {
  constexpr double kHardly = 1.0;  // chi-square of all candidates together: these two expect the same everywhere
  const auto knowledge = std::make_shared<const Knowledge>(cell, all.effects, all.columns);
  const Eigen::Index base = baseColumns(*knowledge, all.columns);
  const std::vector<Span> spans = spansOf(base, all.columns);
  const std::vector<WhiteRows> taken = knowledge->taken(), expected = knowledge->expected(candidates);
  std::vector<Fitted> fits;
  std::vector<std::string> alike;
  for (const Span& span : spans) fits.push_back(fitted(taken, knowledge->prior(), base, span));
  Progress told(options.progress, "which explanations poses tell apart", spans.size());
  told.show();
  for (std::size_t i = 1; i < spans.size(); ++i) {
    told.advance();
    if (all.rivals.front().probability >= options.odds * all.rivals[i].probability) continue;
    std::vector<AskedContrast> both;
    for (const auto& [right, wrong] : {std::pair(std::size_t{0}, i), std::pair(i, std::size_t{0})}) {
      both.push_back(contrastOf(knowledge, base, fits[right], spans[right], fits[wrong], spans[wrong]));
      both.back().before.log_odds = std::log(all.rivals[right].probability / all.rivals[wrong].probability);
    }
    const std::string finding = nameOf(all.rivals.front()), rival = nameOf(all.rivals[i]);
    if (std::max(mostChiSquare(both.front(), expected), mostChiSquare(both.back(), expected)) < kHardly) {
      alike.push_back(rival);
      continue;
    }
    question.pairs.push_back({finding, rival, std::exp(both.front().before.log_odds), 1.0});
    question.pairs.push_back({rival, finding, std::exp(both.back().before.log_odds), 1.0});
    std::move(both.begin(), both.end(), std::back_inserter(question.asked));
  }
  told.finish();
  if (alike.empty()) return;
  question.not_told.push_back(fmt::format("{} and {} expect the same in every pose{}", nameOf(all.rivals.front()), fmt::join(alike, ", "),
                                          separate_with.empty() ? "" : ": " + separate_with));
}

bool hangsOnSides(const Driver& driver) { return driver.kind() == DriverKind::kDirection; }

/// "EFFECT@PLACE" or "EFFECT@PLACE/DRIVER".
Rival parsed(const std::string& text) {
  const std::size_t at = text.find('@'), slash = text.find('/');
  if (at == std::string::npos || at == 0 || at + 1 == text.size()) {
    throw InvalidArgument(fmt::format("'{}' is no effect at a place, expected one like joint_coupling@joint:6", text));
  }
  Rival asked{text.substr(0, at), text.substr(at + 1, slash == std::string::npos ? slash : slash - at - 1), ""};
  if (slash != std::string::npos) asked.driver = text.substr(slash + 1);
  return asked;
}

/// Instances that --detect means.
std::vector<Candidate> askedFor(const Rival& asked, const CandidateList& list) {
  const EffectKind& kind = effectKind(asked.effect);  // names those that there are
  if (kind.add_derivative == nullptr) {
    throw InvalidArgument(fmt::format("{} is random: repeats of any poses show it, and no choice of poses shows it better", asked.effect));
  }
  constexpr double kHighestOrder = 6.0;
  std::vector<Candidate> instances;
  std::vector<std::string> places;
  for (const Candidate& candidate : list.candidates) {
    if (candidate.name != asked.effect) continue;
    const std::string place = candidate.place.name() + "/" + candidate.driver.name();
    if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
    if (candidate.place.name() != asked.location || (!asked.driver.empty() && candidate.driver.name() != asked.driver)) continue;
    if (candidate.slipTime())
      throw InvalidArgument(fmt::format("{} happens at a time: poses do not decide whether it shows", asked.effect));
    const std::vector<EffectParameter>& parameters = candidate.effect->parameters();
    const auto high = std::find_if(parameters.begin(), parameters.end(), [](const EffectParameter& p) { return p.name == "order"; });
    if (high != parameters.end() && candidate.parameters(high - parameters.begin()) > kHighestOrder) continue;
    instances.push_back(candidate);
  }
  if (!instances.empty()) return instances;
  for (const NotTestable& other : list.not_testable) {
    if (other.effect == asked.effect && other.location == asked.location) {
      throw InsufficientData(fmt::format("{}@{} cannot be planned for: {}", other.effect, other.location, other.why));
    }
  }
  const std::string place = asked.location + (asked.driver.empty() ? "" : "/" + asked.driver);
  throw InvalidArgument(fmt::format("{} is not at {}, expected one of: {}", asked.effect, place, choices(place, std::move(places))));
}

}  // namespace

std::vector<Contrast> Question::contrasts(const std::vector<Sample>& samples, const ProgressFunction& progress) const {
  Progress told(progress, kShowing, asked.size());
  told.show();
  std::map<const Knowledge*, std::vector<WhiteRows>> expected;
  std::vector<Contrast> all;
  for (const AskedContrast& each : asked) {
    if (!expected.contains(each.knowledge.get())) expected[each.knowledge.get()] = each.knowledge->expected(samples);
    Contrast& contrast = all.emplace_back(each.before);
    contrast.rows = std::make_shared<const std::vector<WhiteRows>>(rowsOf(each, expected[each.knowledge.get()]));
    told.advance();
  }
  return all;
}

Question separation(const PlanningCell& cell, const std::vector<Sample>& candidates, const PlanOptions& options) {
  if (cell.open.empty()) throw InsufficientData("no finding of the diagnosis has alternatives: there is nothing to tell apart");
  Question question;
  for (const Rivals& rivals : cell.open) {
    const Explanations all = explanationsOf(cell, rivals, options.progress, question.not_told);
    if (all.rivals.size() > 1 && nameOf(all.rivals.front()) == nameOf(rivals.explanations.front()))
      addContrasts(cell, all, candidates, options, rivals.separate_with, question);
    for (const Rival& rival : all.rivals) question.sides_matter = question.sides_matter || hangsOnSides(Driver(rival.driver));
  }
  if (question.asked.empty()) {
    throw InsufficientData(
        question.not_told.empty()
            ? fmt::format("every finding is {:.0f} times as likely as each of its alternatives: nothing is open", options.odds)
            : fmt::format("other poses do not tell these apart: {}", fmt::join(question.not_told, "; ")));
  }
  return question;
}

Question detection(const PlanningCell& cell, const std::vector<Sample>& candidates, const PlanOptions& options) {
  const Rival effect = parsed(options.detect);
  const Knowledge plain(cell, cell.model.effects);
  MeasuredCell measured = plain.measured();
  measured.samples.insert(measured.samples.end(), candidates.begin(), candidates.end());
  const std::vector<Candidate> instances = askedFor(effect, allCandidates(measured, plain.state()));
  Question question;
  Progress told(options.progress, "how the effect would show", instances.size());
  told.show();
  for (const Candidate& instance : instances) {
    const auto knowledge =
        std::make_shared<const Knowledge>(cell, cell.model.effects, std::vector<FurtherColumns>{{instance, instance.typical}});
    const Eigen::Index base = plain.columns();
    const std::vector<WhiteRows> taken = knowledge->taken();
    for (Eigen::Index size = 0; size < instance.own(); ++size) {
      AskedContrast asked{.knowledge = knowledge,
                          .before = {.information = plain.prior().precision, .v = Eigen::VectorXd::Zero(base)},
                          .base = base,
                          .mean = options.detect_size * Eigen::VectorXd::Unit(knowledge->columns(), base + size)};
      for (const WhiteRows& rows : rowsOf(asked, taken)) asked.before.add(rows, 1.0);
      question.asked.push_back(std::move(asked));
    }
    question.sides_matter = question.sides_matter || hangsOnSides(instance.driver);
    told.advance();
  }
  return question;
}

}  // namespace poecal
