// The queue of one connection: a ring that never allocates after its construction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "nodes/graph/message.h"

namespace turnlight::nodes::graph {

// What happens to a message that meets a full queue.
struct Policy {
  enum class Kind {
    kBlock,     // the publisher waits for room
    kKeepLast,  // the oldest message is dropped and counted
  };
  Kind kind = Kind::kBlock;
  std::size_t capacity = 1;

  bool block() const { return kind == Kind::kBlock; }
};

class MessageQueue {
 public:
  explicit MessageQueue(Policy policy) : policy_(policy), ring_(policy.capacity) {}

  enum class Pushed { kStored, kReplacedOldest, kFull };
  // arrival orders the messages of all queues of a node; arrived_at is when it came. On kFull the
  // message is left untouched.
  Pushed Push(AnyMessage&& message, std::uint64_t arrival, Time arrived_at) {
    Pushed pushed = Pushed::kStored;
    if (size_ == ring_.size()) {
      if (policy_.block()) return Pushed::kFull;
      first_ = Next(first_);
      --size_;
      pushed = Pushed::kReplacedOldest;
    }
    std::size_t at = first_ + size_;
    if (at >= ring_.size()) at -= ring_.size();
    ring_[at] = {std::move(message), arrival, arrived_at};
    ++size_;
    return pushed;
  }
  // Only of a queue that is not empty.
  AnyMessage Pop() {
    AnyMessage message = std::move(ring_[first_].message);
    first_ = Next(first_);
    --size_;
    return message;
  }
  void Clear() {
    while (size_ > 0) Pop();
  }

  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == ring_.size(); }
  std::size_t size() const { return size_; }
  std::uint64_t front_arrival() const { return ring_[first_].arrival; }
  Time front_arrived_at() const { return ring_[first_].arrived_at; }
  const Policy& policy() const { return policy_; }

 private:
  struct Slot {
    AnyMessage message;
    std::uint64_t arrival = 0;
    Time arrived_at{};
  };
  std::size_t Next(std::size_t at) const { return at + 1 == ring_.size() ? 0 : at + 1; }

  Policy policy_;
  std::vector<Slot> ring_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace turnlight::nodes::graph
