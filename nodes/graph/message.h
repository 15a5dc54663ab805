// What travels on the bus: an immutable value, shared without a copy, and a header by value.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "base/result.h"
#include "nodes/graph/time.h"
#include "nodes/graph/wire.h"

namespace turnlight::nodes::graph {

struct Header {
  std::uint64_t sequence = 0;  // 0, 1, 2, ... on each output port
  Time valid_at{};             // the instant that the content describes; set by the publisher
  Time processed_at{};         // the instant at which it was published; set by the executor
};

template <typename T>
struct Message {
  Header header;
  std::shared_ptr<const T> value;  // never null

  const T& operator*() const { return *value; }
  const T* operator->() const { return value.get(); }
};

// The same with the type left out: what queues hold.
struct AnyMessage {
  Header header;
  std::shared_ptr<const void> value;
};

// Takes over: no count of the shared value changes.
template <typename T>
Message<T> Typed(AnyMessage&& message) {
  return {message.header, std::static_pointer_cast<const T>(std::move(message.value))};
}

// What the bus and the log know of a type. One object per type: its address is the type's identity.
struct MessageType {
  std::string name;
  std::uint32_t version;
  void (*encode)(const void* value, WireWriter& out);
  std::shared_ptr<const void> (*decode)(WireReader& in);
};

// kName, or Name() for a template whose name is put together.
template <typename T>
std::string TypeName() {
  if constexpr (requires { Wire<T>::Name(); }) {
    return Wire<T>::Name();
  } else {
    return std::string(Wire<T>::kName);
  }
}

template <typename T>
const MessageType& TypeOf() {
  static const MessageType kType{TypeName<T>(), Wire<T>::kVersion,
                                 [](const void* value, WireWriter& out) {
                                   Wire<T>::Encode(*static_cast<const T*>(value), out);
                                 },
                                 [](WireReader& in) -> std::shared_ptr<const void> {
                                   return std::make_shared<const T>(Wire<T>::Decode(in));
                                 }};
  return kType;
}

// "Frame v1".
inline std::string ShowType(const MessageType& type) {
  return type.name + " v" + std::to_string(type.version);
}

// Fails (kInput) if the bytes are not exactly one value of the type.
Result<std::shared_ptr<const void>> DecodeMessage(const MessageType& type, std::string_view bytes);

}  // namespace turnlight::nodes::graph
