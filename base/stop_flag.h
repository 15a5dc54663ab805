// A flag by which a long call is asked to end: set by another thread, a callback or a signal
// handler. Without a flag a call runs to its end.
#pragma once

#include <atomic>

namespace turnlight {

using StopFlag = std::atomic<bool>;
static_assert(StopFlag::is_always_lock_free, "a signal handler may set it");

inline bool StopRequested(const StopFlag* stop) { return stop != nullptr && stop->load(); }

}  // namespace turnlight
