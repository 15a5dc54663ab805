// Proves: the names that people write are understood, and others refused with what is allowed.
#include "calib/calibrate/lens/lens_model_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::calib::calibrate::lens {
namespace {

using testing::HasSubstr;

std::string Refusal(const std::string& name) {
  const auto full = FullLensModelName(name, "--lens");
  return full ? "taken as " + *full : full.error().text;
}

TEST(LensModelName, ShortAndLongNamesAreTheSame) {
  EXPECT_EQ(*FullLensModelName("OPENCV8", "--lens"), "LENSMODEL_OPENCV8");
  EXPECT_EQ(*FullLensModelName("opencv4", "--lens"), "LENSMODEL_OPENCV4");
  EXPECT_EQ(*FullLensModelName("LENSMODEL_CAHVOR", "--lens"), "LENSMODEL_CAHVOR");
  const std::string splined = "SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=18_fov_x_deg=60";
  EXPECT_EQ(*FullLensModelName(splined, "--lens"), "LENSMODEL_" + splined);
  EXPECT_TRUE(IsSplined("LENSMODEL_" + splined));
  EXPECT_FALSE(IsSplined("LENSMODEL_OPENCV8"));
}

TEST(LensModelName, RefusesWhatMrcalDoesNotFit) {
  EXPECT_THAT(Refusal("FISHEYE"), HasSubstr("--lens: 'FISHEYE' is no lens model; allowed are "
                                            "PINHOLE, STEREOGRAPHIC, "));
  EXPECT_THAT(Refusal(""), HasSubstr("is no lens model"));
  EXPECT_THAT(Refusal(std::string("OPENCV8\0x", 9)), HasSubstr("is no lens model"));
  EXPECT_THAT(Refusal("CAHVORE_linearity=0.3"), HasSubstr("has no derivatives"));
  EXPECT_THAT(Refusal("SPLINED_STEREOGRAPHIC"), HasSubstr("lacks its configuration, for example"));
  EXPECT_THAT(Refusal("SPLINED_STEREOGRAPHIC_order=3_Nx=300_Ny=180_fov_x_deg=60"),
              HasSubstr("has 108004 parameters, allowed are at most 4000"));
  EXPECT_THAT(Refusal("SPLINED_STEREOGRAPHIC_order=7_Nx=30_Ny=18_fov_x_deg=60"),
              HasSubstr("order must be 2 or 3"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::lens
