#include "app/outputs.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <iostream>
#include <streambuf>
#include <system_error>

#include "app/exit_code.h"

namespace turnlight::app {
namespace {

constexpr std::size_t kOutputBytes = 1 << 14;

// Opened for reading: a write says that it is closed.
void FillStandardDescriptors() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(fd, F_GETFD) < 0 && errno == EBADF) [[maybe_unused]]
      const int opened = ::open("/dev/null", O_RDONLY);  // the lowest that is free: this one
}

}  // namespace

bool HangupIsIgnored() {
  struct sigaction action {};
  return ::sigaction(SIGHUP, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

// A buffer that keeps why a write has failed.
class StandardOutput::Buffer : public std::streambuf {
 public:
  Buffer() { setp(bytes_.data(), bytes_.data() + bytes_.size()); }
  int error() const { return error_; }  // an errno; 0: none

 protected:
  int sync() override {
    const char* at = pbase();
    while (error_ == 0 && at < pptr()) {
      const ssize_t written = ::write(STDOUT_FILENO, at, static_cast<std::size_t>(pptr() - at));
      if (written > 0)
        at += written;
      else if (errno == EAGAIN)
        AwaitRoom();
      else if (errno != EINTR)
        error_ = errno;
    }
    setp(bytes_.data(), bytes_.data() + bytes_.size());
    return error_ == 0 ? 0 : -1;
  }
  int_type overflow(int_type c) override {
    if (sync() != 0) return traits_type::eof();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }

 private:
  // Whoever shares the terminal may have made it one that does not wait.
  static void AwaitRoom() {
    pollfd output{STDOUT_FILENO, POLLOUT, 0};
    ::poll(&output, 1, -1);
  }

  std::array<char, kOutputBytes> bytes_{};
  int error_ = 0;
};

StandardOutput::StandardOutput() : buffer_(std::make_unique<Buffer>()) {
  FillStandardDescriptors();
  std::signal(SIGPIPE, SIG_IGN);
  before_ = std::cout.rdbuf(buffer_.get());
}

StandardOutput::~StandardOutput() { std::cout.rdbuf(before_); }

int StandardOutput::End(int exit_code) {
  std::cout.flush();
  const int error = buffer_->error();
  if (error == 0) return exit_code;
  if (error != EPIPE)
    std::cerr << "turnlight: standard output: "
              << (error == EBADF ? "it is closed" : std::generic_category().message(error))
              << "; what should have been written there is lost, files are not" << std::endl;
  if (exit_code != kDone) return exit_code;
  return error == EPIPE ? kReaderGone : kRefused;
}

OutputWatch::OutputWatch(const std::vector<int>& descriptors, void (*lost)()) {
  std::vector<pollfd> watched;
  for (const int fd : descriptors)
    if (::fcntl(fd, F_GETFD) >= 0 && !(::isatty(fd) == 1 && HangupIsIgnored()))
      watched.push_back({fd, 0, 0});  // errors and hang-ups are always told
  wake_ = ::eventfd(0, EFD_CLOEXEC);
  if (watched.empty() || wake_ < 0) return;
  watched.push_back({wake_, POLLIN, 0});
  // Signals are for the thread that began: `simulate` waits for them.
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, &before);
  thread_ = std::thread([watched, lost]() mutable {
    while (::poll(watched.data(), watched.size(), -1) < 0 && errno == EINTR) {
    }
    if (watched.back().revents == 0) lost();
  });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

OutputWatch::~OutputWatch() {
  const std::uint64_t one = 1;
  if (thread_.joinable() && ::write(wake_, &one, sizeof one) == sizeof one) thread_.join();
  if (wake_ >= 0) ::close(wake_);
}

}  // namespace turnlight::app
