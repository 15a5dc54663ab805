// Parts of which the studies' summaries are made.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/studies/score.h"
#include "bench/studies/study_file.h"
#include "bench/studies/summary.h"

namespace turnlight::studies {

// "  holds  COUNT RIGHT        190 of 200 = 95.0 %, wanted 95 %"; "none" instead, and nothing
// decided, if there is nothing to judge.
void Accept(Summary& summary, const std::string& what, std::size_t good, std::size_t all,
            double wanted_share);
// The same with a measured value and what it may be at most.
void AcceptAtMost(Summary& summary, const std::string& what, double value, double limit,
                  const char* unit);

std::vector<Quantity> Quantities(const Json& record);

// A table: per name of a quantity how many, the share within 1, 2, 3 and 4 sigma, median and
// largest error in sigmas, median relative error, median of sigma over error.
std::string QuantityTable(const std::vector<const Json*>& records);

// A table of how many records are right, by the value of a key.
std::string Breakdown(const std::vector<const Json*>& records, const std::string& title,
                      const std::function<std::string(const Json&)>& group,
                      const std::function<bool(const Json&)>& right);

// The summaries of the studies that need their own.
Summary SummariseSessions(const StudyFile& file);
Summary SummariseCoverage(const StudyFile& file);
Summary SummariseExtremes(const StudyFile& file);
Summary SummariseLights(const StudyFile& file);
Summary SummariseHard(const StudyFile& file, int worst);

// Records without "failed" and "left_out"; the others are told in `text`.
std::vector<const Json*> Measured(const StudyFile& file, std::string& text);

// How many records there are, those without a result too; not those left out beforehand.
std::size_t Attempted(const StudyFile& file);

// Whether the number of lights is right.
bool Right(const Json& record);
// And every light lies near its true one.
bool RightBasin(const Json& record, double within_deg);

// Of a record's lights; 180 if one is missing. In sigmas: infinite if the sigma is null.
double WorstDirection(const Json& record);
double WorstDirectionInSigmas(const Json& record);

std::string Times(const std::vector<const Json*>& records);
// One line about a record, for lists of the worst.
std::string SceneLine(const Json& record);

// Whether a record says beforehand that the number of lights may be wrong.
bool WarnedOfCount(const Json& record);

}  // namespace turnlight::studies
