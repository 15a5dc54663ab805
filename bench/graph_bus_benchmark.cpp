// The bus beside what one would write without it: a queue with a mutex and a condition variable
// that passes shared pointers, and a bus that copies every message into the queue.
//
//   Hop      two threads (in virtual: two nodes) send one message to and fro; the time of a hop is
//   from
//            just before the sending to the first line of the receiver's handler. median_us,
//            p99_us.
//   Paced    the same after a pause of 1 ms, when the receiver sleeps and must be woken.
//   Stream   one sends as fast as the other takes, 64 in the queue. messages_per_s.
// Messages: Small, 8 bytes, made anew for every hop; Frame, 1920 x 1200 of 16 bit, 4.6 MB, passed
// on.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "nodes/graph/graph.h"

namespace turnlight::nodes::graph {

struct Small {
  std::int64_t number = 0;
};
struct Frame {
  std::vector<std::uint16_t> pixels = std::vector<std::uint16_t>(std::size_t{1920} * 1200);
};
template <>
struct Wire<Small> {
  static constexpr std::string_view kName = "Small";
  static constexpr std::uint32_t kVersion = 1;
  static void Encode(const Small& small, WireWriter& out) { out.I64(small.number); }
  static Small Decode(WireReader& in) { return {in.I64()}; }
};
template <>
struct Wire<Frame> {
  static constexpr std::string_view kName = "Frame";
  static constexpr std::uint32_t kVersion = 1;
  static void Encode(const Frame& frame, WireWriter& out) {
    out.Numbers(std::span<const std::uint16_t>(frame.pixels));
  }
  static Frame Decode(WireReader& in) { return {in.Numbers<std::uint16_t>()}; }
};

namespace {

using SteadyClock = std::chrono::steady_clock;
using namespace std::chrono_literals;

// The next message to send: a small one is made anew, a frame is passed on.
std::shared_ptr<const Small> Next(const std::shared_ptr<const Small>& before) {
  return std::make_shared<const Small>(Small{before->number + 1});
}
std::shared_ptr<const Frame> Next(const std::shared_ptr<const Frame>& before) { return before; }

struct Samples {
  std::vector<Duration> hops;
  void Tell(benchmark::State& state) {
    if (hops.empty()) return;
    std::sort(hops.begin(), hops.end());
    const auto at = [this](double part) {
      return 1e3 *
             ToMs(hops[static_cast<std::size_t>(part * static_cast<double>(hops.size() - 1))]);
    };
    state.counters["median_us"] = at(0.5);
    state.counters["p99_us"] = at(0.99);
  }
};

void Rest(bool paced) {
  if (paced) std::this_thread::sleep_for(1ms);
}

// ---- the bus ----

struct Game {
  std::size_t hops = 0;
  bool paced = false;
  std::size_t done = 0;  // handlers take turns: the message is the baton
  Samples samples;
};

template <typename T>
class Player : public Node {
 public:
  Player(Game& game, bool serves) : game_(game), serves_(serves) {}
  Status Start() override {
    if (serves_) out_.Publish(std::make_shared<const T>(), clock_.Now());
    return {};
  }

 private:
  Status OnMessage(const Message<T>& message) {
    const Time now = clock_.Now();
    game_.samples.hops.push_back(now - message.header.processed_at);
    if (++game_.done == game_.hops) return {};
    Rest(game_.paced);
    out_.Publish(Next(message.value), now);
    return {};
  }
  Game& game_;
  bool serves_;
  Clock clock_{this};
  Input<T> in_{this, "in", &Player::OnMessage};
  Output<T> out_{this, "out"};
};

template <typename T>
class Sender : public Node {
 public:
  explicit Sender(std::size_t count) : count_(count) {}
  Status Start() override {
    const auto message = std::make_shared<const T>();
    for (std::size_t i = 0; i < count_; ++i) out_.Publish(Next(message), Time(0));
    return {};
  }

 private:
  std::size_t count_;
  Output<T> out_{this, "out"};
};
template <typename T>
class Taker : public Node {
  Status OnMessage(const Message<T>& message) {
    benchmark::DoNotOptimize(message.value.get());
    return {};
  }
  Input<T> in_{this, "in", &Taker::OnMessage};
};

// Runs a graph of two nodes of types "a" and "b"; true if it went well.
bool RunTwo(const std::string& executor, const NodeRegistry& registry,
            const std::string& connections) {
  auto config = ParseGraphConfig("graph:\n  executor: " + executor +
                                     "\n  nodes: {a: {type: a}, b: {type: b}}\n  connections: [" +
                                     connections + "]\n",
                                 "bench");
  if (!config) return false;
  auto graph = Graph::Build(std::move(*config), registry);
  if (!graph) return false;
  const auto report = graph->Run();
  return report && !report->failure;
}

template <typename T>
void BusHop(benchmark::State& state, const char* executor, std::size_t hops, bool paced) {
  for (auto _ : state) {
    Game game{hops, paced, 0, {}};
    game.samples.hops.reserve(hops);
    NodeRegistry registry;
    registry.Add("a", [&game] { return std::make_unique<Player<T>>(game, true); });
    registry.Add("b", [&game] { return std::make_unique<Player<T>>(game, false); });
    const auto began = SteadyClock::now();
    if (!RunTwo(executor, registry,
                "{from: a.out, to: b.in, policy: {keep_last: 1}}, "
                "{from: b.out, to: a.in, policy: {keep_last: 1}}"))
      state.SkipWithError("the graph failed");
    const double seconds = std::chrono::duration<double>(SteadyClock::now() - began).count();
    state.counters["messages_per_s"] = static_cast<double>(hops) / seconds;
    // In virtual time a hop is 1 ns by definition; what it costs is in messages_per_s.
    if (std::string_view(executor) == "wall") game.samples.Tell(state);
  }
}

template <typename T>
void BusStream(benchmark::State& state, const char* executor, std::size_t count) {
  for (auto _ : state) {
    NodeRegistry registry;
    registry.Add("a", [count] { return std::make_unique<Sender<T>>(count); });
    registry.Add("b", [] { return std::make_unique<Taker<T>>(); });
    const auto began = SteadyClock::now();
    if (!RunTwo(executor, registry, "{from: a.out, to: b.in, policy: block, capacity: 64}"))
      state.SkipWithError("the graph failed");
    const double seconds = std::chrono::duration<double>(SteadyClock::now() - began).count();
    state.counters["messages_per_s"] = static_cast<double>(count) / seconds;
  }
}

// ---- without the bus ----

// Item is a shared pointer, or the message itself, copied in.
template <typename Item>
class LockedQueue {
 public:
  explicit LockedQueue(std::size_t capacity) : capacity_(capacity) {}
  void Push(Item item) {
    std::unique_lock lock(mutex_);
    space_.wait(lock, [this] { return items_.size() < capacity_; });
    items_.push_back(std::move(item));
    filled_.notify_one();
  }
  Item Pop() {
    std::unique_lock lock(mutex_);
    filled_.wait(lock, [this] { return !items_.empty(); });
    Item item = std::move(items_.front());
    items_.pop_front();
    space_.notify_one();
    return item;
  }

 private:
  std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable filled_, space_;
  std::deque<Item> items_;
};

template <typename T>
struct Shared {
  std::shared_ptr<const T> message;
  SteadyClock::time_point sent;
  static Shared Of(const std::shared_ptr<const T>& next) { return {next, SteadyClock::now()}; }
  std::shared_ptr<const T> Get() const { return message; }
};
template <typename T>
struct Copied {
  T message;
  SteadyClock::time_point sent;
  static Copied Of(const std::shared_ptr<const T>& next) {
    const auto now = SteadyClock::now();
    return {*next, now};
  }
  // The receiver owns it now; sending it on copies it again.
  std::shared_ptr<const T> Get() { return std::make_shared<const T>(std::move(message)); }
};

template <typename T, template <typename> typename Item>
void QueueHop(benchmark::State& state, std::size_t hops, bool paced) {
  for (auto _ : state) {
    LockedQueue<Item<T>> there(1), back(1);
    Samples samples;
    samples.hops.reserve(hops);
    const auto play = [&](LockedQueue<Item<T>>& in, LockedQueue<Item<T>>& out) {
      for (std::size_t i = 0; i < hops / 2; ++i) {
        Item<T> item = in.Pop();
        samples.hops.push_back(SteadyClock::now() - item.sent);
        const auto message = item.Get();
        Rest(paced);
        out.Push(Item<T>::Of(Next(message)));
      }
    };
    const auto began = SteadyClock::now();
    there.Push(Item<T>::Of(std::make_shared<const T>()));
    std::thread other([&] { play(there, back); });
    play(back, there);
    other.join();
    const double seconds = std::chrono::duration<double>(SteadyClock::now() - began).count();
    state.counters["messages_per_s"] = static_cast<double>(hops) / seconds;
    samples.Tell(state);
  }
}

template <typename T, template <typename> typename Item>
void QueueStream(benchmark::State& state, std::size_t count) {
  for (auto _ : state) {
    LockedQueue<Item<T>> queue(64);
    const auto began = SteadyClock::now();
    std::thread taker([&] {
      for (std::size_t i = 0; i < count; ++i) benchmark::DoNotOptimize(queue.Pop());
    });
    const auto message = std::make_shared<const T>();
    for (std::size_t i = 0; i < count; ++i) queue.Push(Item<T>::Of(Next(message)));
    taker.join();
    const double seconds = std::chrono::duration<double>(SteadyClock::now() - began).count();
    state.counters["messages_per_s"] = static_cast<double>(count) / seconds;
  }
}

void RegisterAll() {
  const auto add = [](const char* name, auto function, auto... arguments) {
    benchmark::RegisterBenchmark(name, function, arguments...)
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  };
  add("Hop/Small/bus virtual", BusHop<Small>, "virtual", 2'000'000, false);
  add("Hop/Small/bus wall", BusHop<Small>, "wall", 200'000, false);
  add("Hop/Small/mutex queue", QueueHop<Small, Shared>, 200'000, false);
  add("Hop/Small/copying bus", QueueHop<Small, Copied>, 200'000, false);
  add("Hop/Frame/bus virtual", BusHop<Frame>, "virtual", 2'000'000, false);
  add("Hop/Frame/bus wall", BusHop<Frame>, "wall", 200'000, false);
  add("Hop/Frame/mutex queue", QueueHop<Frame, Shared>, 200'000, false);
  add("Hop/Frame/copying bus", QueueHop<Frame, Copied>, 1'000, false);
  add("Paced/Small/bus wall", BusHop<Small>, "wall", 1'000, true);
  add("Paced/Small/mutex queue", QueueHop<Small, Shared>, 1'000, true);
  add("Stream/Small/bus virtual", BusStream<Small>, "virtual", 2'000'000);
  add("Stream/Small/bus wall", BusStream<Small>, "wall", 1'000'000);
  add("Stream/Small/mutex queue", QueueStream<Small, Shared>, 1'000'000);
  add("Stream/Small/copying bus", QueueStream<Small, Copied>, 1'000'000);
  add("Stream/Frame/bus wall", BusStream<Frame>, "wall", 1'000'000);
  add("Stream/Frame/mutex queue", QueueStream<Frame, Shared>, 1'000'000);
  add("Stream/Frame/copying bus", QueueStream<Frame, Copied>, 1'000);
}

}  // namespace
}  // namespace turnlight::nodes::graph

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  turnlight::nodes::graph::RegisterAll();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
