// The tile kernel in single precision for one instruction set; see tile_kernel.h.
#define TURNLIGHT_DOT_LANES 16
#define TURNLIGHT_DOT_COLUMNS 4
#include "estimator/solve/kernel/tile_kernel_body.h"

namespace turnlight::estimator::solve::kernel {

extern const KernelFunctions kKernelAvx512;
const KernelFunctions kKernelAvx512 = {
    [](const KernelModel& model, const KernelPixels& pixels, float* workspace, KernelSums& out) {
      AccumulateTiles<float>(model, pixels, workspace, out);
    },
    [](const KernelModel& model, const KernelPixels& pixels, float* workspace, float* const* out) {
      PredictTiles<float>(model, pixels, workspace, out);
    },
    "avx512"};

}  // namespace turnlight::estimator::solve::kernel
