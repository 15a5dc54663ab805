#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "nodes/graph/crc32c.h"
#include "nodes/graph/log.h"
#include "nodes/graph/log_format.h"

namespace turnlight::nodes::graph {
namespace {

std::uint32_t U32At(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

std::uint16_t TopicOf(const std::string& body) {
  std::uint16_t topic = 0;
  if (body.size() >= 2) std::memcpy(&topic, body.data(), 2);
  return topic;
}

LogRecord RecordOf(const std::string& body, std::uint64_t offset) {
  LogRecord record;
  WireReader in(std::string_view(body).substr(0, log_format::kRecordHeaderBytes));
  record.offset = offset;
  record.topic = in.U16();
  record.header.sequence = in.U64();
  record.header.valid_at = Time(in.I64());
  record.header.processed_at = Time(in.I64());
  record.bytes = body.substr(log_format::kRecordHeaderBytes);
  return record;
}

}  // namespace

Result<LogReader> LogReader::Open(const std::filesystem::path& path) {
  LogReader reader;
  reader.path_ = path;
  reader.file_.reset(std::fopen(path.c_str(), "rbe"));
  if (!reader.file_)
    return InputError(path.string() + ": cannot open the log: " + std::strerror(errno) +
                      ", allowed is the file log in the folder of a run");
  struct stat info {};
  if (::fstat(::fileno(reader.file_.get()), &info) != 0 || !S_ISREG(info.st_mode))
    return InputError(path.string() + ": not a regular file");
  reader.size_ = static_cast<std::uint64_t>(info.st_size);
  if (Status status = reader.ReadHeader(); !status) return Forward(status);
  reader.tail_.valid_bytes = reader.at_;
  return reader;
}

Status LogReader::ReadHeader() {
  const std::string name = path_.string();
  std::string front;
  if (!Read(front, log_format::kMagic.size() + 12) || !front.starts_with(log_format::kMagic))
    return InputError(name + ": not a turnlight log");
  const std::size_t fields = log_format::kMagic.size();
  const std::uint32_t version = U32At(front, fields);
  const std::uint32_t length = U32At(front, fields + 4);
  if (version != log_format::kVersion)
    return InputError(name + ": log format " + std::to_string(version) + ", allowed is " +
                      std::to_string(log_format::kVersion));
  std::string body;
  if (length > log_format::kMaxHeader || !Read(body, length) ||
      Crc32c(body) != U32At(front, fields + 8))
    return InputError(name + ": the log's header is damaged");
  WireReader in(body);
  header_.config_hash = in.Text();
  header_.seed = in.U64();
  const std::uint32_t count = in.U32();
  for (std::uint32_t i = 0; i < count && in.Left() > 0; ++i) {
    LogTopic topic;
    topic.topic = in.Text();
    topic.type = in.Text();
    topic.version = in.U32();
    header_.topics.push_back(std::move(topic));
  }
  if (Status status = in.Finish(); !status || header_.topics.size() != count)
    return InputError(name + ": the log's header is damaged");
  return {};
}

bool LogReader::Read(std::string& to, std::size_t count) {
  if (count > size_ - at_) return false;
  to.resize(count);
  if (count > 0 && std::fread(to.data(), 1, count, file_.get()) != count) return false;
  at_ += count;
  return true;
}

std::string LogReader::ReadBody(std::string& body) {
  std::string prefix;
  if (!Read(prefix, log_format::kPrefixBytes)) return "cut off in a record's first 8 bytes";
  const std::uint32_t length = U32At(prefix, 0);
  if (length == 0) return "zeros where a record should begin";
  if (length > size_ - at_)
    return "cut off in a record of " + std::to_string(length) + " bytes, of which " +
           std::to_string(size_ - at_) + " are there";
  if (!Read(body, length)) return std::string("cannot read: ") + std::strerror(errno);
  if (Crc32c(body, Crc32c(std::string_view(prefix).substr(0, 4))) != U32At(prefix, 4))
    return "the checksum of a record is wrong";
  return {};
}

std::optional<LogRecord> LogReader::Next() {
  if (ended_) return std::nullopt;
  const std::uint64_t offset = at_;
  std::string body;
  std::string reason = at_ == size_ ? "no end record: the run was cut off" : ReadBody(body);
  if (reason.empty() && TopicOf(body) == log_format::kEndTopic) {
    WireReader in(body);
    in.U16();
    const std::uint64_t count = in.U64();
    const StopMode mode = in.U8() == 1 ? StopMode::kNow : StopMode::kDrain;
    const Time stopped(in.I64());
    if (in.Finish() && count == records_) {
      tail_ = {true, LogStop{mode, stopped}, at_, size_ - at_, ""};
      ended_ = true;
      return std::nullopt;
    }
    reason = "the end record counts " + std::to_string(count) + " records, " +
             std::to_string(records_) + " are there";
  } else if (reason.empty() && (body.size() < log_format::kRecordHeaderBytes ||
                                TopicOf(body) >= header_.topics.size())) {
    reason = "a record of no topic";
  }
  if (!reason.empty()) {
    ended_ = true;
    tail_ = {false, std::nullopt, offset, size_ - offset,
             "at byte " + std::to_string(offset) + ": " + reason};
    return std::nullopt;
  }
  ++records_;
  tail_.valid_bytes = at_;
  return RecordOf(body, offset);
}

Result<LogRecord> LogReader::ReadAt(std::uint64_t offset) {
  const std::string here = path_.string() + ": at byte " + std::to_string(offset) + ": ";
  if (offset >= size_ || std::fseek(file_.get(), static_cast<long>(offset), SEEK_SET) != 0)
    return InputError(here + "no record");
  at_ = offset;
  ended_ = true;  // the place of Next is lost
  std::string body;
  std::string reason = ReadBody(body);
  if (reason.empty() &&
      (body.size() < log_format::kRecordHeaderBytes || TopicOf(body) >= header_.topics.size()))
    reason = "a record of no topic";
  if (!reason.empty()) return InputError(here + reason);
  return RecordOf(body, offset);
}

}  // namespace turnlight::nodes::graph
