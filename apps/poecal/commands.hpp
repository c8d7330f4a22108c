// The commands, each set up in a file of its own under commands/.
#pragma once

#include "command.hpp"

namespace poecal::app {

std::function<int()> setUpCheck(CLI::App& app, const Common& common);
std::function<int()> setUpCompensate(CLI::App& app, const Common& common);
std::function<int()> setUpCompletion(CLI::App& app, const Common& common);
std::function<int()> setUpDetect(CLI::App& app, const Common& common);
std::function<int()> setUpDiagnose(CLI::App& app, const Common& common);
std::function<int()> setUpEffects(CLI::App& app, const Common& common);
std::function<int()> setUpExport(CLI::App& app, const Common& common);
std::function<int()> setUpFleet(CLI::App& app, const Common& common);
std::function<int()> setUpIdentify(CLI::App& app, const Common& common);
std::function<int()> setUpIntrinsics(CLI::App& app, const Common& common);
std::function<int()> setUpMeasure(CLI::App& app, const Common& common);
std::function<int()> setUpNew(CLI::App& app, const Common& common);
std::function<int()> setUpPaper(CLI::App& app, const Common& common);
std::function<int()> setUpPlan(CLI::App& app, const Common& common);
std::function<int()> setUpPredict(CLI::App& app, const Common& common);
std::function<int()> setUpReport(CLI::App& app, const Common& common);
std::function<int()> setUpRun(CLI::App& app, const Common& common);
std::function<int()> setUpSimulate(CLI::App& app, const Common& common);
std::function<int()> setUpTarget(CLI::App& app, const Common& common);

}  // namespace poecal::app
