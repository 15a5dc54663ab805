// Proves that a log gives back what was written, that a log cut off or damaged anywhere gives back
// what is in front of the damage and says so, that a disk which fails stops the run with a message,
// and that a comparison names the first message that differs. Does not prove durability across a
// power loss: that would take a disk that lies.
#include <sys/resource.h>

#include <csignal>
#include <fstream>

#include "base/file.h"
#include "nodes/graph/crc32c.h"
#include "tests/nodes/graph/graph_testing.h"

namespace turnlight::nodes::graph {
namespace {

using testing::HasSubstr;

TEST(Crc32c, KnownAnswers) {
  EXPECT_EQ(Crc32c(""), 0u);
  EXPECT_EQ(Crc32c("123456789"), 0xE3069283u);
  EXPECT_EQ(Crc32c(std::string(32, '\0')), 0x8A9136AAu);  // RFC 3720, B.4
  EXPECT_EQ(Crc32c(std::string(32, '\xff')), 0x62A8AB43u);
  EXPECT_EQ(Crc32c("6789", Crc32c("12345")), 0xE3069283u);
}

LogHeader Topics() { return {"hash", 7, {{"a.number", "Number", 1}, {"b.word", "Word", 3}}}; }
AnyMessage NumberAt(std::uint64_t sequence, double value) {
  return {{sequence, Time(10 * sequence), Time(20 * sequence)},
          std::make_shared<const Number>(Number{value})};
}
AnyMessage WordAt(std::uint64_t sequence, std::string text) {
  return {{sequence, Time(1), Time(2)}, std::make_shared<const Word>(Word{std::move(text)})};
}

// Three numbers and two words, closed.
void WriteSample(const std::filesystem::path& path, double third = 3.0, Time stop = Time(99)) {
  auto log = LogWriter::Create(path, Topics());
  ASSERT_TRUE(log) << ErrorOf(log);
  (*log)->Append(0, TypeOf<Number>(), NumberAt(0, 1.0));
  (*log)->Append(1, TypeOf<Word>(), WordAt(0, "one"));
  (*log)->Append(0, TypeOf<Number>(), NumberAt(1, 2.0));
  (*log)->Append(0, TypeOf<Number>(), NumberAt(2, third));
  (*log)->Append(1, TypeOf<Word>(), WordAt(1, "the last"));
  const Status closed = (*log)->Close({StopMode::kDrain, stop});
  ASSERT_TRUE(closed) << ErrorOf(closed);
}

struct Contents {
  std::vector<LogRecord> records;
  LogTail tail;
};
Contents ReadAll(const std::filesystem::path& path) {
  Contents contents;
  auto log = LogReader::Open(path);
  EXPECT_TRUE(log) << ErrorOf(log);
  if (!log) return contents;
  while (auto record = log->Next()) contents.records.push_back(std::move(*record));
  contents.tail = log->tail();
  return contents;
}
void WriteBytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(Log, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  WriteSample(folder / "log");
  auto log = LogReader::Open(folder / "log");
  ASSERT_TRUE(log) << ErrorOf(log);
  EXPECT_EQ(log->header(), Topics());
  const Contents contents = ReadAll(folder / "log");
  ASSERT_EQ(contents.records.size(), 5u);
  EXPECT_TRUE(contents.tail.whole);
  EXPECT_EQ(contents.tail.lost_bytes, 0u);
  EXPECT_EQ(contents.tail.stop, (LogStop{StopMode::kDrain, Time(99)}));
  const LogRecord& third = contents.records[2];
  EXPECT_EQ(third.topic, 0);
  EXPECT_EQ(third.header.sequence, 1u);
  EXPECT_EQ(third.header.valid_at, Time(10));
  EXPECT_EQ(third.header.processed_at, Time(20));
  const auto value = DecodeMessage(TypeOf<Number>(), third.bytes);
  ASSERT_TRUE(value);
  EXPECT_EQ(static_cast<const Number*>(value->get())->value, 2.0);
  const auto again = log->ReadAt(third.offset);
  ASSERT_TRUE(again) << ErrorOf(again);
  EXPECT_EQ(again->bytes, third.bytes);
  EXPECT_FALSE(log->ReadAt(third.offset + 1));
}

TEST(Log, CutOffAtEveryByteGivesTheRecordsInFrontOfTheCut) {
  const TemporaryFolder folder;
  WriteSample(folder / "log");
  const std::string bytes = ReadFile(folder / "log").value();
  const Contents whole = ReadAll(folder / "log");
  std::size_t header_end = whole.records[0].offset;
  for (std::size_t size = header_end; size < bytes.size(); ++size) {
    WriteBytes(folder / "cut", bytes.substr(0, size));
    const Contents cut = ReadAll(folder / "cut");
    std::size_t complete = 0;
    for (std::size_t i = 0; i < whole.records.size(); ++i) {
      const std::size_t end =
          i + 1 < whole.records.size() ? whole.records[i + 1].offset : bytes.size() - 27;
      if (end <= size) complete = i + 1;
    }
    ASSERT_EQ(cut.records.size(), complete) << size;
    EXPECT_FALSE(cut.tail.whole);
    EXPECT_EQ(cut.tail.valid_bytes + cut.tail.lost_bytes, size);
    EXPECT_THAT(cut.tail.reason, testing::StartsWith("at byte "));
  }
  for (std::size_t size = 0; size < header_end; ++size) {
    WriteBytes(folder / "cut", bytes.substr(0, size));
    EXPECT_FALSE(LogReader::Open(folder / "cut")) << size;
  }
}

TEST(Log, EveryAlteredByteIsFound) {
  const TemporaryFolder folder;
  WriteSample(folder / "log");
  const std::string bytes = ReadFile(folder / "log").value();
  const Contents whole = ReadAll(folder / "log");
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string altered = bytes;
    altered[at] = static_cast<char>(altered[at] ^ 0x10);
    WriteBytes(folder / "altered", altered);
    auto log = LogReader::Open(folder / "altered");
    if (at < whole.records[0].offset) {
      EXPECT_FALSE(log) << at;
      continue;
    }
    ASSERT_TRUE(log) << at << ErrorOf(log);
    std::size_t good = 0;
    while (log->Next()) ++good;
    EXPECT_FALSE(log->tail().whole) << at;
    EXPECT_GT(log->tail().lost_bytes, 0u) << at;
    for (std::size_t i = 0; i < good; ++i) EXPECT_LT(whole.records[i].offset, at);
  }
}

TEST(Log, AZeroFilledTailIsTold) {
  const TemporaryFolder folder;
  WriteSample(folder / "log");
  const std::string bytes = ReadFile(folder / "log").value();
  const Contents whole = ReadAll(folder / "log");
  WriteBytes(folder / "zeros", bytes.substr(0, whole.records[4].offset) + std::string(4096, '\0'));
  const Contents cut = ReadAll(folder / "zeros");
  EXPECT_EQ(cut.records.size(), 4u);
  EXPECT_THAT(cut.tail.reason, HasSubstr("zeros where a record should begin"));
  EXPECT_EQ(cut.tail.lost_bytes, 4096u);
}

TEST(Log, RefusesWhatIsNoLogAndOtherFormats) {
  const TemporaryFolder folder;
  WriteBytes(folder / "text", "turnlight-log is not one, however long it goes on");
  EXPECT_THAT(ErrorOf(LogReader::Open(folder / "text")), HasSubstr("text: not a turnlight log"));
  EXPECT_THAT(ErrorOf(LogReader::Open(folder / "none")), HasSubstr("cannot open the log"));
  WriteSample(folder / "log");
  std::string bytes = ReadFile(folder / "log").value();
  bytes[16] = 2;
  WriteBytes(folder / "next", bytes);
  EXPECT_THAT(ErrorOf(LogReader::Open(folder / "next")), HasSubstr("log format 2, allowed is 1"));
}

TEST(Log, DoesNotOverwrite) {
  const TemporaryFolder folder;
  WriteSample(folder / "log");
  EXPECT_THAT(ErrorOf(LogWriter::Create(folder / "log", Topics())),
              HasSubstr("cannot create the log: File exists"));
  EXPECT_THAT(ErrorOf(LogWriter::Create(folder / "no/log", Topics())),
              HasSubstr("No such file or directory"));
}

// The file may not grow beyond a limit: write() fails as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST(Log, AFullDiskStopsTheRunInOrderAndKeepsWhatWasWritten) {
  for (const std::string executor : {"virtual", "wall"}) {
    const TemporaryFolder folder;
    Seen seen;
    NodeRegistry registry = BasicNodes();
    AddSink(registry, seen);
    RunReport report;
    {
      const FileSizeLimit limit(1000);
      report = RunGraph("graph:\n  executor: " + executor + R"(
  nodes:
    count: {type: counter, params: {count: 100000, period_ms: 0.1}}
    sink: {type: sink}
  connections:
    - {from: count.number, to: sink.in, policy: block}
  record: [count.number]
)",
                        registry, {.log = folder / "log"});
    }
    EXPECT_EQ(report.cause, StopCause::kFault);
    ASSERT_TRUE(report.failure);
    EXPECT_EQ(report.failure->node, "graph");
    EXPECT_EQ(report.failure->code, "log");
    EXPECT_THAT(report.failure->text, HasSubstr("log: cannot write: File too large"));
    EXPECT_LT(seen.values.size(), 100000u);
    const Contents contents = ReadAll(folder / "log");
    EXPECT_GT(contents.records.size(), 10u);
    EXPECT_FALSE(contents.tail.whole);
  }
}

std::string Difference(const std::filesystem::path& a, const std::filesystem::path& b,
                       CompareMode mode = CompareMode::kExact) {
  const auto difference = CompareLogs(a, b, mode);
  EXPECT_TRUE(difference) << ErrorOf(difference);
  return difference && *difference ? (*difference)->text : "";
}

TEST(CompareLogs, NamesTheFirstMessageThatDiffers) {
  const TemporaryFolder folder;
  WriteSample(folder / "a");
  WriteSample(folder / "b");
  EXPECT_EQ(Difference(folder / "a", folder / "b"), "");
  WriteSample(folder / "c", 3.0000001);
  const auto difference = CompareLogs(folder / "a", folder / "c", CompareMode::kExact);
  ASSERT_TRUE(difference && *difference);
  EXPECT_EQ((*difference)->topic, "a.number");
  EXPECT_EQ((*difference)->sequence, 2u);
  EXPECT_EQ((*difference)->byte, 0u);
  EXPECT_EQ((*difference)->text, "a.number #2 differs at byte 0 of 8");
  WriteSample(folder / "d", 3.0, Time(100));
  EXPECT_EQ(Difference(folder / "a", folder / "d"),
            "the ends differ: stopped in order at 99 ns and stopped in order at 100 ns");
  EXPECT_EQ(Difference(folder / "a", folder / "d", CompareMode::kContent), "");
}

TEST(CompareLogs, NamesMissingMessagesOtherTimesOrderAndHeaders) {
  const TemporaryFolder folder;
  const auto write = [&folder](const std::string& name, std::vector<AnyMessage> numbers,
                               bool word_first = false, std::uint64_t seed = 7) {
    LogHeader header = Topics();
    header.seed = seed;
    auto log = LogWriter::Create(folder / name, header);
    ASSERT_TRUE(log);
    if (word_first) (*log)->Append(1, TypeOf<Word>(), WordAt(0, "w"));
    for (const AnyMessage& number : numbers) (*log)->Append(0, TypeOf<Number>(), number);
    if (!word_first) (*log)->Append(1, TypeOf<Word>(), WordAt(0, "w"));
    ASSERT_TRUE((*log)->Close({}));
  };
  write("a", {NumberAt(0, 1), NumberAt(1, 2)});
  write("short", {NumberAt(0, 1)});
  write("order", {NumberAt(0, 1), NumberAt(1, 2)}, true);
  AnyMessage late = NumberAt(1, 2);
  late.header.processed_at = Time(21);
  write("late", {NumberAt(0, 1), late});
  write("seed", {NumberAt(0, 1), NumberAt(1, 2)}, false, 8);
  EXPECT_THAT(Difference(folder / "a", folder / "short"),
              HasSubstr("the first log has a.number #1 where the second has b.word #0"));
  EXPECT_EQ(Difference(folder / "a", folder / "short", CompareMode::kContent),
            "a.number #1 is only in the first log");
  EXPECT_THAT(Difference(folder / "a", folder / "order"),
              HasSubstr("the first log has a.number #0 where the second has b.word #0"));
  EXPECT_EQ(Difference(folder / "a", folder / "order", CompareMode::kContent), "");
  EXPECT_EQ(Difference(folder / "a", folder / "late"),
            "a.number #1 is processed at 20 ns and 21 ns");
  EXPECT_EQ(Difference(folder / "a", folder / "late", CompareMode::kContent), "");
  EXPECT_EQ(Difference(folder / "a", folder / "seed"), "the headers differ: seed 7 and 8");
}

}  // namespace
}  // namespace turnlight::nodes::graph
