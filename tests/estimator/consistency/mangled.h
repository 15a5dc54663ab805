// Captures of random scenes with mistakes in them, as people make them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/rig_geometry.h"
#include "estimator/consistency/pose_doubts.h"
#include "rig/sim/synthetic_session.h"

namespace turnlight::estimator::consistency {

struct Capture {
  rig::sim::SyntheticSession session;
  std::vector<double> angles_deg;
};

enum class Shape { kLump, kSphere };

// One to three lights and a highlight, noise of a good camera, a turning table.
rig::sim::SyntheticConfig RandomCapture(std::uint64_t seed, Shape shape, int frames);
Capture Captured(const rig::sim::SyntheticConfig& config);
// The same in small pictures, for quick tests.
rig::sim::SyntheticConfig SmallCapture(std::uint64_t seed, Shape shape, int frames);
// Of a lump that looks the same after each turn by 360 / fold degrees.
Capture CapturedSymmetric(std::uint64_t seed, int fold, int frames);

// With pictures of its own.
Capture CopyOf(const Capture& capture);

// What can be wrong with one frame.
inline constexpr const char* kOddKinds[] = {"black", "dimmed", "turned",   "byte-swapped", "stale",
                                            "half",  "moved",  "mirrored", "wrong-mask"};
void MakeOdd(Capture& capture, const std::string& kind, std::size_t frame);
// All frames get masks: of what is bright, or of what the target covers.
void GiveMasks(Capture& capture);
void GiveOutlines(Capture& capture);
// Bright things stand and move behind the target.
void ClutterBackground(Capture& capture, std::uint64_t seed);

// What can be wrong with all poses.
inline constexpr const char* kPoseMistakes[] = {
    "angles-reversed", "factor 2",    "factor 0.98", "order-reversed", "order-shuffled",
    "camera-inverted", "camera-axes", "length-unit", "target-place",   "target-inverted"};
void MisplacePoses(Capture& capture, const std::string& mistake, std::uint64_t seed);

// Whether what was found is that mistake, or one that pictures cannot tell from it.
bool NamesMistake(const Consistency& found, const std::string& mistake);

// The lamp's strength of each frame: uniform within +- share of 1, or rising by it.
void LetLampDrift(Capture& capture, double share, bool at_random, std::uint64_t seed);

SmallViews SmallViewsOf(const Capture& capture, const target::Geometry& geometry);

}  // namespace turnlight::estimator::consistency
