// The tile kernel in single precision for one instruction set; see tile_kernel.h.
#define TURNLIGHT_DOT_LANES 8
#define TURNLIGHT_DOT_COLUMNS 2
#include "estimator/solve/kernel/tile_kernel_body.h"

namespace turnlight::estimator::solve::kernel {

extern const KernelFunctions kKernelAvx2;
const KernelFunctions kKernelAvx2 = {
    [](const KernelModel& model, const KernelPixels& pixels, float* workspace, KernelSums& out) {
      AccumulateTiles<float>(model, pixels, workspace, out);
    },
    [](const KernelModel& model, const KernelPixels& pixels, float* workspace, float* const* out) {
      PredictTiles<float>(model, pixels, workspace, out);
    },
    "avx2"};

}  // namespace turnlight::estimator::solve::kernel
