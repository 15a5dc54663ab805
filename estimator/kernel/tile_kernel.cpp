#include "estimator/kernel/tile_kernel.h"

namespace turnlight::estimator::kernel {

extern const KernelFunctions kKernel_baseline;
#if defined(__x86_64__)
extern const KernelFunctions kKernel_avx2;
extern const KernelFunctions kKernel_avx512;
#endif

int RunnableKernels(const KernelFunctions** out, int max) {
  int count = 0;
  const auto add = [&](const KernelFunctions& functions) {
    if (count < max) out[count++] = &functions;
  };
  add(kKernel_baseline);
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) add(kKernel_avx2);
  if (__builtin_cpu_supports("avx512f")) add(kKernel_avx512);
#endif
  return count;
}

const KernelFunctions& BestKernel() {
  static const KernelFunctions* best = [] {
    const KernelFunctions* all[3];
    return all[RunnableKernels(all, 3) - 1];
  }();
  return *best;
}

}  // namespace turnlight::estimator::kernel
