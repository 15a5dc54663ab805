#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/file.h"
#include "nodes/graph/crc32c.h"
#include "nodes/graph/log.h"
#include "nodes/graph/log_format.h"

namespace turnlight::nodes::graph {
namespace {

// The name is durable only when the folder is.
bool SyncFolder(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool synced = ::fsync(fd) == 0;
  ::close(fd);
  return synced;
}

std::string EncodeHeader(const LogHeader& header) {
  std::string body;
  WireWriter out(body);
  out.Text(header.config_hash);
  out.U64(header.seed);
  out.U32(static_cast<std::uint32_t>(header.topics.size()));
  for (const LogTopic& topic : header.topics) {
    out.Text(topic.topic);
    out.Text(topic.type);
    out.U32(topic.version);
  }
  std::string bytes(log_format::kMagic);
  WireWriter front(bytes);
  front.U32(log_format::kVersion);
  front.U32(static_cast<std::uint32_t>(body.size()));
  front.U32(Crc32c(body));
  return bytes + body;
}

}  // namespace

Result<std::unique_ptr<LogWriter>> LogWriter::Create(const std::filesystem::path& path,
                                                     const LogHeader& header) {
  if (header.topics.size() >= log_format::kEndTopic)
    return InputError(path.string() + ": " + std::to_string(header.topics.size()) +
                      " topics, allowed are at most " + std::to_string(log_format::kEndTopic - 1));
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd < 0)
    return SystemError(path.string() + ": cannot create the log: " + std::strerror(errno));
  std::unique_ptr<LogWriter> writer(new LogWriter(path, fd));
  writer->Write(EncodeHeader(header));
  writer->Sync();
  if (!writer->failed() && !SyncFolder(path))
    writer->Fail(std::string("cannot sync its folder: ") + std::strerror(errno));
  if (Status status = writer->status(); !status) return Forward(status);
  return writer;
}

LogWriter::~LogWriter() {
  if (fd_ >= 0) ::close(fd_);
}

void LogWriter::Append(std::uint16_t topic, const MessageType& type, const AnyMessage& message) {
  const std::lock_guard lock(mutex_);
  if (fd_ < 0 || failed()) return;
  buffer_.assign(log_format::kPrefixBytes, '\0');
  WireWriter out(buffer_);
  out.U16(topic);
  out.U64(message.header.sequence);
  out.I64(message.header.valid_at.count());
  out.I64(message.header.processed_at.count());
  type.encode(message.value.get(), out);
  WriteRecord();
  ++records_;
  if (std::chrono::steady_clock::now() - synced_ > std::chrono::seconds(1)) Sync();
}

Status LogWriter::Close(const LogStop& stop) {
  const std::lock_guard lock(mutex_);
  if (fd_ < 0) return status_;
  if (!failed()) {
    buffer_.assign(log_format::kPrefixBytes, '\0');
    WireWriter out(buffer_);
    out.U16(log_format::kEndTopic);
    out.U64(records_);
    out.U8(stop.mode == StopMode::kNow ? 1 : 0);
    out.I64(stop.at.count());
    WriteRecord();
    Sync();
  }
  if (::close(std::exchange(fd_, -1)) != 0)
    Fail(std::string("cannot close: ") + std::strerror(errno));
  return status_;
}

Status LogWriter::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void LogWriter::WriteRecord() {
  const std::size_t length = buffer_.size() - log_format::kPrefixBytes;
  if (length > log_format::kMaxBody)
    return Fail("a message of " + std::to_string(length) + " bytes, allowed are at most " +
                std::to_string(log_format::kMaxBody));
  const auto length32 = static_cast<std::uint32_t>(length);
  std::memcpy(buffer_.data(), &length32, 4);
  const std::string_view all(buffer_);
  const std::uint32_t crc = Crc32c(all.substr(log_format::kPrefixBytes), Crc32c(all.substr(0, 4)));
  std::memcpy(buffer_.data() + 4, &crc, 4);
  Write(buffer_);
}

void LogWriter::Write(std::string_view bytes) {
  if (!failed() && !WriteAll(fd_, bytes))
    Fail(std::string("cannot write: ") + std::strerror(errno));
}

void LogWriter::Sync() {
  if (!failed() && ::fdatasync(fd_) != 0) Fail(std::string("cannot sync: ") + std::strerror(errno));
  synced_ = std::chrono::steady_clock::now();
}

void LogWriter::Fail(std::string text) {
  if (status_) status_ = SystemError(path_.string() + ": " + std::move(text));
  failed_.store(true, std::memory_order_relaxed);
}

}  // namespace turnlight::nodes::graph
