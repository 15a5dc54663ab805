// session.json as text: parsed into a Session, and written from one. Internal to this folder; knows
// nothing of the other files of a session.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/strict_object.h"
#include "rig/session/session.h"

namespace turnlight::rig {

// A session with everything that is wrong with its text. With problems, the session holds harmless
// values in the places that were refused.
struct ParsedSession {
  Session session;  // without root and camera
  std::vector<std::string> problems;
};

// file names the text in messages. Goes on after a bad frame, so that all are listed.
ParsedSession ParseSession(const std::string& text, const std::string& file);

// One frame a line; every double reads back to the same bits.
std::string PrintSession(const Session& session);

// One frame, as it stands in session.json and in journal.jsonl. What is refused is added to
// problems.
FrameRecord ParseFrame(StrictObject object, std::vector<std::string>& problems);
nlohmann::ordered_json PrintFrame(const FrameRecord& frame);

}  // namespace turnlight::rig
