// Every message that judges measurements and advises, in one table: refusals of an estimate, its
// notes, the verdicts about a capture. docs/messages.md is the same table for people, and a test
// keeps them together.
//
// A new message is a row here, the same row there, and `Text` where it is said. What it says to do
// has to follow from its condition: two causes are two rows.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::messages {

enum class Kind {
  kRefusal,  // ends an estimate, exit code 5
  kNote,     // of a result
  kVerdict   // about a capture
};

struct Row {
  // Stable. Of a note its code in result.json; where one code has several causes "code/cause".
  const char* id;
  Kind kind;
  const char* condition;  // when it is said, in terms of what is measured
  const char* words;      // what was found; {name} stands for a value
  const char* todo;       // what to do; may have values, too, and may be empty
};

const std::vector<Row>& Table();

// A row's {names} by their texts.
using Values = std::map<std::string, std::string>;

// Words and what to do, with the values in place. The id must be in the table, and all its names
// in `values`.
std::string Text(const std::string& id, const Values& values = {});
// "views-add-nothing" of "views-add-nothing/copies".
std::string CodeOf(const std::string& id);

// The refusal as an error (kNoEstimate): "no usable estimate: " and its text.
tl::unexpected<Error> Refuse(const std::string& id, const Values& values = {});

}  // namespace turnlight::messages
