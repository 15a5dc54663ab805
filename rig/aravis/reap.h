// Ends what is tedious to end where nobody waits for it: Aravis takes 7.5 s to let go of a camera
// that no longer answers.
#pragma once

#include <thread>
#include <utility>

namespace turnlight::rig::aravis {

template <typename T>
void Reap(T object) {
  std::thread([owned = std::move(object)]() mutable { T ended = std::move(owned); }).detach();
}

}  // namespace turnlight::rig::aravis
