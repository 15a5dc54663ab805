// The inner loop of the estimator: model, residual and Jacobian of a tile of pixels, and their
// sums.
//
// Plain data only: this header is compiled for several instruction sets, and anything inline from a
// library would be linked for the wrong one. All variants do the same operations in the same order
// without contraction, so they give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace turnlight::estimator::solve::kernel {

inline constexpr int kLanes = 16;
inline constexpr int kTilePixels = 256;
inline constexpr std::uint32_t kNoPixel = 0xFFFFFFFFu;  // fills up a tile
inline constexpr int kMaxSamples = 8;                   // per side of a footprint
inline constexpr int kPerLight = 4;                     // intensity, two tangents, inverse distance
inline constexpr int kMostLobes = 2;
inline constexpr int kHarmonics = 8;  // of the ambient light
inline constexpr int kMostBeforeLights = 3 + 3 * kMostLobes + 2 * kHarmonics;
inline constexpr int kDiffuseConstants = 4;

struct KernelLight {
  double direction[3];
  double tangent[2][3];
  double inverse_distance;
  double intensity;
};

struct KernelLobe {
  int number;  // in model::reflectance::Lobes
  double strength, shape, f0;
  int strength_row, shape_row, f0_row;  // the last: -1 if it has none
};

// The model, and everything about it that does not change from pixel to pixel.
struct KernelModel {
  int channels;
  int lights;
  const KernelLight* light;
  double albedo[3];
  double ambient, diffuse;
  bool harmonics;  // the ambient light depends on the normal
  double harmonic[kHarmonics];
  bool shades;  // the diffuse part departs from its model with the normal
  double shading[kHarmonics];
  int diffuse_model;  // number in model::reflectance::DiffuseModels
  double diffuse_constants[kDiffuseConstants];
  int lobes;
  KernelLobe lobe[kMostLobes];
  // Rows of the parameters that all lights share; those of the lights follow.
  int ambient_row, diffuse_row, roughness_row, first_light_row;
  // Of the first of each; -1 if they are not unknowns.
  int harmonics_row, shading_row;
  double huber;        // 0: squares
  bool weighted;       // the pixels have weights
  int white_bits;      // of the pixels' at_white: any of them makes the residual one-sided
  bool gradient_only;  // leave out the sums of products of rows
  // Gauss-Legendre nodes on [-1/2, 1/2] and weights (sum 1) for each number of samples per side.
  double node[kMaxSamples + 1][kMaxSamples];
  double weight[kMaxSamples + 1][kMaxSamples];
  // Cholesky factor of [sum O^2, sum O; sum O, channels].
  double l11, l21, l22;

  int Shared() const { return first_light_row + kPerLight * lights; }
};

// Pointers to one chunk's arrays of Observations; count is a multiple of kTilePixels.
struct KernelPixels {
  const float* position[3];
  const float* normal[3];
  const float* mirrored[3];
  const std::uint16_t* footprint[6];  // change of the mirrored direction
  const std::uint16_t* step[6];       // change of the position
  const float* radiance[3];
  const std::uint32_t* pixel;
  const float* weight;  // of each pixel's residuals; or null for 1
  // Not 0 where the radiance is at white: a model above it is no residual. Bit by channel, of one
  // channel at a time; of all together a model above it in their sum. Or null for none.
  const std::uint8_t* at_white;
  const std::uint8_t* samples;     // per tile, or null for 1
  const std::uint8_t* const* lit;  // per light, 1 or 0 for each pixel; or null for 1
  const std::uint8_t* usable;      // 1 or 0 for each pixel; or null for 1
  std::size_t tiles;
};

// Sums over a chunk. n = KernelModel::Shared(), C = channels.
struct KernelSums {
  double* shared;             // n * n, upper triangle (i <= j): sum of J_i J_j
  double* gradient;           // n: sum of J_i r
  double* albedo_a;           // n: sum of E a_i, E = k_a + k_d sum I D
  double* albedo_b;           // n: sum of E b_i
  double albedo_square;       // sum of E^2
  double albedo_gradient[3];  // per channel: sum of E r_c
  double cost;
};

// Rows are handled in blocks of four.
constexpr int PaddedRows(int shared) { return (shared + 3) / 4 * 4; }
inline constexpr int kExtraRows = 6;
// Lane sums of the products of all pairs of rows, by blocks.
constexpr int PairSums(int shared) {
  const int blocks = PaddedRows(shared) / 4;
  return blocks * (blocks + 1) / 2 * 16 * kLanes;
}
// Room for the rows of a tile and the lane sums, in scalars of the kernel's type.
constexpr std::size_t WorkspaceSize(int shared) {
  return static_cast<std::size_t>((2 * PaddedRows(shared) + kExtraRows) * kTilePixels +
                                  PairSums(shared) + (3 * shared + 4) * kLanes);
}

using AccumulateFunction = void (*)(const KernelModel&, const KernelPixels&, float* workspace,
                                    KernelSums&);
using PredictFunction = void (*)(const KernelModel&, const KernelPixels&, float* workspace,
                                 float* const* out);

struct KernelFunctions {
  AccumulateFunction accumulate;
  PredictFunction predict;  // out[c]: tiles * kTilePixels values of model radiance
  const char* name;
};

// The fastest variant that this processor runs.
const KernelFunctions& BestKernel();
// Every variant that this processor runs, slowest first.
int RunnableKernels(const KernelFunctions** out, int max);

void AccumulateInDouble(const KernelModel&, const KernelPixels&, double* workspace, KernelSums&);

}  // namespace turnlight::estimator::solve::kernel
