#include "nodes/graph/message.h"

#include <exception>

namespace turnlight::nodes::graph {

Result<std::shared_ptr<const void>> DecodeMessage(const MessageType& type, std::string_view bytes) {
  WireReader in(bytes);
  std::string problem;
  try {
    auto value = type.decode(in);
    const Status status = in.Finish();
    if (status) return value;
    problem = status.error().text;
  } catch (const std::exception& exception) {
    problem = exception.what();
  }
  return InputError("not a " + ShowType(type) + ": " + problem);
}

}  // namespace turnlight::nodes::graph
