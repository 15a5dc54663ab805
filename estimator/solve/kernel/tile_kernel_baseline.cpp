// The tile kernel in single precision for one instruction set; see tile_kernel.h.
#include "estimator/solve/kernel/tile_kernel_body.h"

namespace turnlight::estimator::solve::kernel {

extern const KernelFunctions kKernelBaseline;
const KernelFunctions kKernelBaseline = {
    [](const KernelModel& model, const KernelPixels& pixels, float* workspace, KernelSums& out) {
      AccumulateTiles<float>(model, pixels, workspace, out);
    },
    [](const KernelModel& model, const KernelPixels& pixels, float* workspace, float* const* out) {
      PredictTiles<float>(model, pixels, workspace, out);
    },
    "baseline"};

}  // namespace turnlight::estimator::solve::kernel
