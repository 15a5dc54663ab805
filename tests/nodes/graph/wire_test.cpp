// Proves that what WireWriter writes WireReader reads back, and that no shortened or altered input
// is taken for a value or read past its end. Does not prove that formats of other versions are
// refused: that is the log's and the replay's business.
#include "nodes/graph/wire.h"

#include "tests/nodes/graph/graph_testing.h"

namespace turnlight::nodes::graph {
namespace {

std::string Sample() {
  std::string bytes;
  WireWriter out(bytes);
  out.U8(250);
  out.U16(65000);
  out.U32(4'000'000'000u);
  out.U64(1ull << 63);
  out.I64(-5);
  out.F32(0.5f);
  out.F64(-1e300);
  out.Bool(true);
  out.Text(std::string_view("d\0t", 3));
  const std::vector<float> numbers{1.0f, 2.0f, 3.0f};
  out.Numbers(std::span<const float>(numbers));
  return bytes;
}

Status ReadSample(std::string_view bytes) {
  WireReader in(bytes);
  const bool same = in.U8() == 250 && in.U16() == 65000 && in.U32() == 4'000'000'000u &&
                    in.U64() == 1ull << 63 && in.I64() == -5 && in.F32() == 0.5f &&
                    in.F64() == -1e300 && in.Bool() && in.Text() == std::string_view("d\0t", 3) &&
                    in.Numbers<float>() == std::vector<float>{1.0f, 2.0f, 3.0f};
  Status status = in.Finish();
  if (status && !same) return InputError("other values");
  return status;
}

TEST(Wire, ReadsBackWhatWasWritten) {
  const Status status = ReadSample(Sample());
  EXPECT_TRUE(status) << ErrorOf(status);
}

TEST(Wire, RefusesEveryShortenedInput) {
  const std::string bytes = Sample();
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(ReadSample(std::string_view(bytes).substr(0, size))) << size;
}

TEST(Wire, RefusesBytesLeftOver) {
  EXPECT_THAT(ErrorOf(ReadSample(Sample() + "x")), testing::HasSubstr("1 bytes are left over"));
}

TEST(Wire, RefusesAListLongerThanTheInputWithoutAllocatingIt) {
  std::string bytes;
  WireWriter out(bytes);
  out.U64(std::uint64_t{1} << 62);
  WireReader numbers(bytes);
  EXPECT_TRUE(numbers.Numbers<double>().empty());
  EXPECT_THAT(ErrorOf(numbers.Finish()), testing::HasSubstr("a list of 4611686018427387904"));
  WireReader text(bytes);
  EXPECT_TRUE(text.Text().empty());
  EXPECT_FALSE(text.Finish());
}

TEST(Wire, RefusesABoolOfTwo) {
  WireReader in("\x02");
  in.Bool();
  EXPECT_THAT(ErrorOf(in.Finish()), testing::HasSubstr("a 0 or 1, not 2"));
}

TEST(Wire, ADecodedMessageNamesItsTypeWhenItIsBroken) {
  EXPECT_THAT(ErrorOf(DecodeMessage(TypeOf<Word>(), "abc")), testing::HasSubstr("not a Word v3"));
}

TEST(Queue, BlockIsFullAtItsCapacityAndKeepsOrder) {
  MessageQueue queue({Policy::Kind::kBlock, 2});
  const auto push = [&queue](std::uint64_t n) {
    return queue.Push({{n, Time(0), Time(0)}, std::make_shared<const int>(0)}, n, Time(0));
  };
  EXPECT_EQ(push(1), MessageQueue::Pushed::kStored);
  EXPECT_EQ(push(2), MessageQueue::Pushed::kStored);
  EXPECT_EQ(push(3), MessageQueue::Pushed::kFull);
  EXPECT_EQ(queue.Pop().header.sequence, 1u);
  EXPECT_EQ(push(4), MessageQueue::Pushed::kStored);
  EXPECT_EQ(queue.Pop().header.sequence, 2u);
  EXPECT_EQ(queue.Pop().header.sequence, 4u);
  EXPECT_TRUE(queue.empty());
}

TEST(Queue, KeepLastDropsTheOldestAndFreesIt) {
  MessageQueue queue({Policy::Kind::kKeepLast, 2});
  auto first = std::make_shared<const int>(1);
  const std::weak_ptr<const int> watch = first;
  queue.Push({{1, Time(0), Time(0)}, std::move(first)}, 1, Time(0));
  queue.Push({{2, Time(0), Time(0)}, std::make_shared<const int>(0)}, 2, Time(0));
  EXPECT_FALSE(watch.expired());
  EXPECT_EQ(queue.Push({{3, Time(0), Time(0)}, std::make_shared<const int>(0)}, 3, Time(0)),
            MessageQueue::Pushed::kReplacedOldest);
  EXPECT_TRUE(watch.expired());
  EXPECT_EQ(queue.Pop().header.sequence, 2u);
  EXPECT_EQ(queue.Pop().header.sequence, 3u);
}

}  // namespace
}  // namespace turnlight::nodes::graph
