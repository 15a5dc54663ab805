// Proves, by counting calls of operator new in the whole process, that a hop allocates nothing when
// a message is passed on and exactly once when it is made anew, and that a value is never copied.
// Does not count what a node's own handler allocates, nor the memory that a run needs once.
#include <atomic>

#include "tests/nodes/graph/graph_testing.h"

extern std::atomic<std::size_t> counted_allocations;  // counting_new.cpp

namespace turnlight::nodes::graph {
namespace {

// Counts its copies; moving it into the message is free.
struct Parcel {
  static inline std::atomic<int> copies{0};
  int hops = 0;
  Parcel() = default;
  explicit Parcel(int count) : hops(count) {}
  Parcel(const Parcel& other) : hops(other.hops) { ++copies; }
  Parcel(Parcel&&) = default;
};
}  // namespace

template <>
struct Wire<Parcel> {
  static constexpr std::string_view kName = "Parcel";
  static constexpr std::uint32_t kVersion = 1;
  static void Encode(const Parcel& parcel, WireWriter& out) { out.I64(parcel.hops); }
  static Parcel Decode(WireReader& in) { return Parcel(static_cast<int>(in.I64())); }
};

namespace {

struct Plan {
  int hops = 0;
  bool anew = false;  // a new message for every hop, or the same passed on
  std::atomic<int> done{0};
};

class Player : public Node {
 public:
  Player(Plan& plan, bool serves) : plan_(plan), serves_(serves) {}
  Status Start() override {
    if (serves_) out_.Publish(Parcel(0), Time(0));
    return {};
  }

 private:
  Status OnParcel(const Message<Parcel>& parcel) {
    if (++plan_.done >= plan_.hops) return {};
    if (plan_.anew)
      out_.Publish(Parcel(parcel->hops + 1), Time(0));
    else
      out_.Publish(parcel.value, Time(0));
    return {};
  }
  Plan& plan_;
  bool serves_;
  Input<Parcel> in_{this, "in", &Player::OnParcel};
  Output<Parcel> out_{this, "out"};
};

std::size_t AllocationsOf(const std::string& executor, int hops, bool anew) {
  Plan plan{hops, anew, {}};
  NodeRegistry registry;
  registry.Add("a", [&plan] { return std::make_unique<Player>(plan, true); });
  registry.Add("b", [&plan] { return std::make_unique<Player>(plan, false); });
  const std::size_t before = counted_allocations;
  RunGraph("graph:\n  executor: " + executor + R"(
  nodes: {a: {type: a}, b: {type: b}}
  connections:
    - {from: a.out, to: b.in, policy: block, capacity: 2}
    - {from: b.out, to: a.in, policy: {keep_last: 2}}
)",
           registry);
  const std::size_t after = counted_allocations;
  EXPECT_EQ(plan.done, hops);
  return after - before;
}

TEST(Allocation, AHopAllocatesNothingBeyondItsMessage) {
  for (const std::string executor : {"virtual", "wall"}) {
    AllocationsOf(executor, 100, true);  // what the process allocates once
    const std::size_t few = AllocationsOf(executor, 1000, false);
    const std::size_t many = AllocationsOf(executor, 11000, false);
    EXPECT_LT(few, 2000u) << "building and running the graph itself";
    EXPECT_EQ(many, few) << "10000 more hops of one message, " << executor;
    const std::size_t anew_few = AllocationsOf(executor, 1000, true);
    const std::size_t anew_many = AllocationsOf(executor, 11000, true);
    EXPECT_EQ(anew_many - anew_few, 10000u) << "one for each message, " << executor;
  }
  EXPECT_EQ(Parcel::copies, 0);
}

}  // namespace
}  // namespace turnlight::nodes::graph
