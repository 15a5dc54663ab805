// The tile kernel in double precision, against which derivatives and rounding are tested.
#include "estimator/solve/kernel/tile_kernel_body.h"

namespace turnlight::estimator::solve::kernel {

void AccumulateInDouble(const KernelModel& model, const KernelPixels& pixels, double* workspace,
                        KernelSums& out) {
  AccumulateTiles<double>(model, pixels, workspace, out);
}

}  // namespace turnlight::estimator::solve::kernel
