#include "base/messages/messages.h"

#include <algorithm>
#include <cassert>

namespace turnlight::messages {

std::string CodeOf(const std::string& id) { return id.substr(0, id.find('/')); }

std::string Text(const std::string& id, const Values& values) {
  const auto row = std::find_if(Table().begin(), Table().end(),
                                [&](const Row& candidate) { return candidate.id == id; });
  assert(row != Table().end());
  std::string text = row->words;
  if (*row->todo != '\0') text += std::string(" ") + row->todo;
  for (const auto& [name, value] : values) {
    const std::string place = "{" + name + "}";
    for (std::size_t at = text.find(place); at != std::string::npos;
         at = text.find(place, at + value.size()))
      text.replace(at, place.size(), value);
  }
  return text;
}

tl::unexpected<Error> Refuse(const std::string& id, const Values& values) {
  return NoEstimateError("no usable estimate: " + Text(id, values));
}

}  // namespace turnlight::messages
