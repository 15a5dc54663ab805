// The log of a run: the recorded topics' messages in the order in which they were published.
//
// Layout, little-endian:
//   16 bytes  "turnlight-log\0\r\n"
//   u32 format (1), u32 length, u32 CRC-32C, then `length` bytes: text config hash, u64 seed,
//       u32 number of topics, for each: text topic, text type, u32 type version
//   records: u32 length, u32 CRC-32C of the length's four bytes and the body, then the body:
//       u16 topic, u64 sequence, i64 valid_at ns, i64 processed_at ns, the message
//   at an orderly end one record with topic 65535: u64 number of records, u8 stop mode, i64 stop
//   time
// A log that ends anywhere else was cut off; everything in front of the cut is read.
// There is no time of day in it: in virtual time the same config and seed give the same bytes.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "nodes/graph/core.h"

namespace turnlight::nodes::graph {

struct LogTopic {
  std::string topic;  // NODE.PORT
  std::string type;
  std::uint32_t version = 0;

  bool operator==(const LogTopic&) const = default;
};

struct LogHeader {
  std::string config_hash;
  std::uint64_t seed = 0;
  std::vector<LogTopic> topics;

  bool operator==(const LogHeader&) const = default;
};

// When and how the run began to stop.
struct LogStop {
  StopMode mode = StopMode::kDrain;
  Time at{};

  bool operator==(const LogStop&) const = default;
};

struct LogRecord {
  std::uint64_t offset = 0;  // of the record in the file
  std::uint16_t topic = 0;   // index into the header's topics
  Header header;
  std::string bytes;  // the message
};

// How a log ends.
struct LogTail {
  bool whole = false;           // it was closed
  std::optional<LogStop> stop;  // of a whole log
  std::uint64_t valid_bytes = 0;
  std::uint64_t lost_bytes = 0;  // behind the last good record
  std::string reason;            // why reading ended, unless whole
};

// Writes at once and syncs to the disk at least every second and at the end. Safe from many
// threads. The first failure is kept; nothing is written after it.
class LogWriter {
 public:
  // Fails (kSystem) if the file exists or cannot be written.
  static Result<std::unique_ptr<LogWriter>> Create(const std::filesystem::path& path,
                                                   const LogHeader& header);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  void Append(std::uint16_t topic, const MessageType& type, const AnyMessage& message);
  Status Close(const LogStop& stop);
  Status status() const;
  bool failed() const { return failed_.load(std::memory_order_relaxed); }

 private:
  LogWriter(std::filesystem::path path, int fd) : path_(std::move(path)), fd_(fd) {}
  void WriteRecord();  // what is in buffer_ behind the place of length and checksum
  void Write(std::string_view bytes);
  void Sync();
  void Fail(std::string text);

  const std::filesystem::path path_;
  mutable std::mutex mutex_;
  int fd_;  // -1 once closed
  std::string buffer_;
  std::uint64_t records_ = 0;
  std::chrono::steady_clock::time_point synced_ = std::chrono::steady_clock::now();
  Status status_;
  std::atomic<bool> failed_{false};
};

class LogReader {
 public:
  // Fails (kInput) if it is not a log of this format or its header is damaged.
  static Result<LogReader> Open(const std::filesystem::path& path);

  const LogHeader& header() const { return header_; }
  // The next record, or nothing at the end; then tail() says what the end is like.
  std::optional<LogRecord> Next();
  const LogTail& tail() const { return tail_; }
  // A record that Next gave before, by its offset. Fails (kInput) if it cannot be read any more.
  Result<LogRecord> ReadAt(std::uint64_t offset);

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  LogReader() = default;
  Status ReadHeader();
  bool Read(std::string& to, std::size_t count);
  // Reads the body of the record at the file's position; returns what is wrong with it, or nothing.
  std::string ReadBody(std::string& body);

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::uint64_t size_ = 0;
  std::uint64_t at_ = 0;
  std::uint64_t records_ = 0;
  LogHeader header_;
  LogTail tail_;
  bool ended_ = false;
};

// The first thing in which two logs differ.
struct LogDifference {
  std::string topic;  // empty: the headers or the ends
  std::uint64_t sequence = 0;
  std::uint64_t byte = 0;  // first differing byte of the message
  std::string text;        // all of it for a person
};

enum class CompareMode {
  kExact,    // every record in its order, with its times: the contract of the virtual executor
  kContent,  // the messages of each topic in their order, without times: a wall run against a
             // virtual
};

// Nothing if they are equal. Fails (kInput) if one cannot be read.
Result<std::optional<LogDifference>> CompareLogs(const std::filesystem::path& first,
                                                 const std::filesystem::path& second,
                                                 CompareMode mode);

}  // namespace turnlight::nodes::graph
