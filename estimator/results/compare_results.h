// Are two results the same within their sigmas and stated tolerances? docs/compare.md is for users.
//
// Method, reflectance model, number and kind (near or distant) of lights, and which quantities are
// known must be equal. Lights are partners by direction: the pairs whose angles have the least sum,
// whatever the order in the files.
//
// Gauge: intensities are relative to the strongest light, albedo to its brightest channel, and
// diffuse, specular and ambient share both. Where the strongest lights are no partners, or another
// channel is the brightest, these cannot be judged; the products can, which do not depend on it.
#pragma once

#include <optional>
#include <vector>

#include "base/comparison.h"
#include "estimator/results/reported_result.h"

namespace turnlight::estimator::results {

// What a tolerance file may name, in the order of a comparison. Lengths are in the session's unit.
const std::vector<QuantityWord>& ResultQuantities();

Comparison CompareResults(const ReportedResult& a, const ReportedResult& b,
                          const Tolerances& tolerances);

// For each light of a the index of its partner in b: as many pairs as the shorter list has lights,
// with the least sum of angles.
std::vector<std::optional<std::size_t>> PartnersByDirection(const std::vector<ReportedLight>& a,
                                                            const std::vector<ReportedLight>& b);

}  // namespace turnlight::estimator::results
