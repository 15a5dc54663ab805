// What the pictures of a session say beside what session.json says of them.
#pragma once

#include <string>
#include <vector>

#include "calib/radiometry.h"
#include "rig/session/picture_claims.h"
#include "rig/session/picture_levels.h"

namespace turnlight::rig {

// Of a frame's picture, besides its pixels.
struct PictureFacts {
  std::string file;  // as session.json names it
  PictureClaims claims;
  PictureLevels levels;
};

struct PictureNote {
  std::string code;  // "encoding-contradicted", "levels-doubtful" or "pictures-read-as"
  std::string text;  // names the first file, how many are so, and what to set
};

// Of the frames that were read, each kind once; empty if files and session agree.
std::vector<PictureNote> PictureNotes(const calib::Radiometry& radiometry,
                                      const std::vector<PictureFacts>& frames);

}  // namespace turnlight::rig
