// Proves: Encode is Decode's inverse for every encoding, below 0 and above 1 too. That the encodings
// are the right ones radiometry_test shows.
#include "calib/transfer.h"

#include <gtest/gtest.h>

namespace turnlight::calib {
namespace {

TEST(Transfer, EncodeIsTheInverse) {
  for (const Encoding encoding :
       {Encoding::kLinear, Encoding::kSrgb, Encoding::kGamma, Encoding::kCurve}) {
    Radiometry radiometry;
    radiometry.encoding = encoding;
    radiometry.curve = {{0.0, 0.0}, {0.3, 0.1}, {1.0, 1.0}};
    const Transfer transfer(radiometry);
    EXPECT_NEAR(transfer.Decode(0.0), 0.0, 1e-15);
    EXPECT_NEAR(transfer.Decode(1.0), 1.0, 1e-15);
    for (double s = -0.2; s < 1.3; s += 0.01)
      EXPECT_NEAR(transfer.Encode(transfer.Decode(s)), s, 1e-12) << static_cast<int>(encoding);
  }
}

}  // namespace
}  // namespace turnlight::calib
