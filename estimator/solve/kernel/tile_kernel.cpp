#include "estimator/solve/kernel/tile_kernel.h"

namespace turnlight::estimator::solve::kernel {

extern const KernelFunctions kKernelBaseline;
#if defined(__x86_64__)
extern const KernelFunctions kKernelAvx2;
extern const KernelFunctions kKernelAvx512;
#endif

int RunnableKernels(const KernelFunctions** out, int max) {
  int count = 0;
  const auto add = [&](const KernelFunctions& functions) {
    if (count < max) out[count++] = &functions;
  };
  add(kKernelBaseline);
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) add(kKernelAvx2);
  if (__builtin_cpu_supports("avx512f")) add(kKernelAvx512);
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

}  // namespace turnlight::estimator::solve::kernel
