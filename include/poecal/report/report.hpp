// The report: a calibration as one page for people, and the data that the page is drawn from.
#pragma once

#include <filesystem>
#include <string>

#include "poecal/calibration/run_capture.hpp"
#include "poecal/core/progress.hpp"

namespace poecal {

/// Whether this build holds the library that draws the charts. @see requireReport().
bool reportBuilt();
/// @throws InvalidArgument with what to install where this build cannot make a page.
void requireReport();

/// Samples that a page shows at most. Of more the worst are kept and the others are thinned evenly; figures are of all.
constexpr std::size_t kMostReportSamples = 1500;

/// Text of report.json (format poecal-report/1): the verdict in words, identification.json, diagnosis.json, and what the pictures of the
/// page need beside them: residuals of every sample by the nominal, registered, identified and diagnosed model, the arm in space, the
/// uncertainty of the tool.
/// @param pictures  the folder with the samples' pictures as report.json names it: relative to its own folder; empty where there is none.
/// @throws InvalidArgument where the arm was not identified.
std::string reportJson(const CalibrationRun& run, const std::string& pictures);

/// The page: data, pictures, style and program in one file that asks nobody for anything.
/// @param json      text of report.json.
/// @param pictures  folder with the pictures; those that are not there are left out, which the page says.
/// @param jobs      pictures read at a time; 0: one per core. The result does not depend on it.
/// @param kept      a file in which the small pictures are kept, so that those that did not change are not made again; empty: none.
/// @param progress  told of each picture; may be empty.
/// @throws InvalidArgument as requireReport().
std::string reportHtml(const std::string& json, const std::filesystem::path& pictures, int jobs, const std::filesystem::path& kept = {},
                       const ProgressFunction& progress = {});

/// Writes OUT/report.json. Nothing where the arm was not identified: such results have no report.
/// @param capture  its folder; empty for poses of an instrument.
void writeReportData(const CalibrationRun& run, const std::filesystem::path& capture, const std::filesystem::path& out);

/// Writes OUT/report.json and, where this build can, OUT/report.html.
/// @param progress  as reportHtml().
/// @returns why there is no page, one clause; empty where there is one.
std::string writeReport(const CalibrationRun& run, const std::filesystem::path& capture, const std::filesystem::path& out, int jobs,
                        const ProgressFunction& progress = {});

/// Writes OUT/report.html from OUT/report.json. @param progress  as reportHtml().
/// @throws FileError: there is no report.json, or it is none. InvalidArgument as requireReport().
void renderReport(const std::filesystem::path& out, int jobs, const ProgressFunction& progress = {});

}  // namespace poecal
