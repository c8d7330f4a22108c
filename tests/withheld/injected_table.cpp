#include "withheld/injected_table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace withheld {
namespace {

/// One case beside its recording.
struct Row {
  const Scored* scored = nullptr;
  const TrueEffect* effect = nullptr;
  bool found = false, absent = false, answered_alone = false;
  const Finding* by_name = nullptr;  ///< the finding that has the effect's own name
  std::vector<std::string> else_new;
};

bool says(const Answer& answer, const TrueEffect& effect) {
  return std::any_of(answer.findings.begin(), answer.findings.end(), [&](const Finding& finding) { return effect.is(finding.place()); });
}

/// Whether a place is among the findings or what these may be instead.
bool names(const Answer& answer, const std::string& place) {
  const auto is_it = [&place](const Named& named) { return named.place() == place; };
  return std::any_of(answer.findings.begin(), answer.findings.end(), [&](const Finding& finding) {
    return is_it(finding) || std::any_of(finding.alternatives.begin(), finding.alternatives.end(), is_it);
  });
}

Row rowOf(const Scored& scored, const Scored* alone) {
  Row row;
  row.scored = &scored;
  row.effect = &scored.truth.effects.front();
  row.found = scored.verdict.fates.front().right;
  row.answered_alone = alone != nullptr && alone->answered;
  row.absent = row.answered_alone && !says(alone->answer, *row.effect);
  for (const Finding& finding : scored.answer.findings) {
    if (finding.place() == placeName(row.effect->effect, row.effect->location)) row.by_name = &finding;
    if (!row.effect->is(finding.place()) && !(alone != nullptr && names(alone->answer, finding.place()))) {
      row.else_new.push_back(finding.place());
    }
  }
  return row;
}

std::string sizes(const Row& row) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : row.effect->parameters) {
    std::string text = fmt::format("{} {:.4g}", name, value);
    if (row.by_name != nullptr && row.by_name->parameters.contains(name) && row.by_name->deviations.contains(name)) {
      text += fmt::format(" ({:.4g} +- {:.2g})", row.by_name->parameters.at(name), row.by_name->deviations.at(name));
    }
    texts.push_back(text);
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string join(const std::vector<std::string>& places) { return places.empty() ? "nothing" : fmt::format("{}", fmt::join(places, ", ")); }

std::string caseRows(const std::vector<Row>& rows) {
  std::string text =
      "\n| case | recording | injected | S | found | size, true (said) | agrees | else new |\n|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    const std::string found = row.found && row.by_name == nullptr ? "as an alias" : row.found ? "yes" : "no";
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", row.scored->truth.folder.filename().string(),
                        row.scored->truth.recording, placeName(row.effect->effect, row.effect->location),
                        row.effect->S > 0.0 ? fmt::format("{:.1f}", row.effect->S) : "-", found, sizes(row),
                        row.by_name == nullptr              ? "-"
                        : agrees(*row.effect, *row.by_name) ? "yes"
                                                            : "no",
                        join(row.else_new));
  }
  return text;
}

std::string shares(const std::vector<Row>& rows) {
  std::string text = "\n| injected into recordings | question | share (cases; Wilson 95 %) |\n|---|---|---|\n";
  const auto add = [&](const std::string& recording, const char* question, const auto& asked, const auto& test) {
    std::size_t hits = 0, of = 0;
    for (const Row& row : rows) {
      if ((!recording.empty() && row.scored->truth.recording != recording) || !asked(row)) continue;
      ++of;
      hits += test(row) ? 1 : 0;
    }
    if (of > 0) text += fmt::format("| {} | {} | {} |\n", recording.empty() ? "all" : recording, question, share(hits, of));
  };
  const auto any = [](const Row&) { return true; };
  std::map<std::string, int> recordings = {{"", 0}};
  for (const Row& row : rows) recordings[row.scored->truth.recording];
  for (const auto& [recording, unused] : recordings) {
    add(recording, "found, in its place", any, [](const Row& row) { return row.found; });
    add(recording, "among findings and alternatives", any, [](const Row& row) { return row.scored->verdict.fates.front().among; });
    add(
        recording, "size agrees, of those found by name", [](const Row& row) { return row.by_name != nullptr; },
        [](const Row& row) { return agrees(*row.effect, *row.by_name); });
    add(
        recording, "absent from the recording as it is", [](const Row& row) { return row.answered_alone; },
        [](const Row& row) { return row.absent; });
    add(recording, "nothing else new", any, [](const Row& row) { return row.else_new.empty(); });
  }
  return text;
}

}  // namespace

bool agrees(const TrueEffect& effect, const Finding& finding) {
  constexpr double kChiSquare95[] = {3.841, 5.991, 7.815, 9.488};  // of 1 to 4 degrees
  double sum = 0.0;
  std::size_t freedom = 0;
  for (const auto& [name, value] : effect.parameters) {
    const auto said = finding.parameters.find(name), deviation = finding.deviations.find(name);
    if (said == finding.parameters.end() || deviation == finding.deviations.end()) return false;
    sum += std::pow((said->second - value) / deviation->second, 2);
    ++freedom;
  }
  return freedom > 0 && freedom <= std::size(kChiSquare95) && sum <= kChiSquare95[freedom - 1];
}

std::string injected(const std::vector<Scored>& cases) {
  std::map<std::string, const Scored*> alone;  // recordings as they are
  for (const Scored& scored : cases) {
    if (!scored.truth.recording.empty() && scored.truth.effects.empty()) alone[scored.truth.recording] = &scored;
  }
  std::vector<Row> rows;
  for (const Scored& scored : cases) {
    if (!scored.truth.recording.empty() && !scored.truth.effects.empty()) rows.push_back(rowOf(scored, alone[scored.truth.recording]));
  }
  std::string text;
  for (const auto& [recording, scored] : alone) {
    if (scored != nullptr) text += fmt::format("\n{} as it is: {}.\n", recording, join(scored->verdict.said));
  }
  return rows.empty() ? text : text + shares(rows) + caseRows(rows);
}

}  // namespace withheld
