// Photographs of balls whose lights are known, one at a time and several together: which scenes the
// study of photographs has, and how a photograph under several lights is made of some under one.
//
// The folder of data may have
//   diligent_ball/single_NAME          a glossy ball under one light each
//   diligent_ball/sumN_NAME_NAME...    the same under N lights, made elsewhere as WriteSum does
//   uw_gray_NAME                       a gray, matte, veined ball under one light each
// each a session with a truth.json.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::studies {

// A set holds the scenes of one ball under the same number of lights: "ball-2/003_067" is a scene
// of the set "ball-2".
struct PhotographScene {
  std::string id;
  std::vector<std::filesystem::path> sessions;  // one: as it lies there; more: to be summed
};

// All of a folder of data, by set: every session that lies there, and sums of single photographs,
// 24 of two, 16 of three and 12 of four of the glossy ball and 12 of two of the gray one, or as
// many as there are. Lights are at least 15 degrees apart in sums of two of the glossy ball, 20 in
// the others. Which ones is a function of the names and directions alone; none is there twice.
// Fails (kInput) if there is no photograph, or one without a truth.
Result<std::vector<PhotographScene>> PhotographScenes(const std::filesystem::path& data);

// Sets of `lights` of these directions (unit vectors) that are at least apart_deg from each other,
// by number, each set ascending: `wanted` different ones, or fewer where so many are not met with
// in many draws.
std::vector<std::vector<std::size_t>> ChooseApart(const std::vector<Eigen::Vector3d>& directions,
                                                  std::size_t lights, double apart_deg,
                                                  std::size_t wanted);

// Writes into `folder` the session that the lights of these sessions, at least two, make together:
// the sum of their radiances, exposed for the N-th part of the time so that it fits; clipped,
// channel by channel, where any of them is; 16 bits. Of the masks what all have in common, of the
// truth the directions. Fails (kInput) unless each has one frame and linear radiometry, and all
// pictures are of one kind.
Status WriteSum(const std::vector<std::filesystem::path>& sessions,
                const std::filesystem::path& folder);

}  // namespace turnlight::studies
