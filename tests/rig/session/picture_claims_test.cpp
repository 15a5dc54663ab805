// Proves: what a picture's file says of its values is told from its kinds of tags, true and hostile
// ones, and is held against a session's encoding without false alarms at neighbouring encodings.
// Does not prove: ICC profiles of every maker; those tried are made by lcms2.
#include "rig/session/picture_claims.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcms2.h>

#include <cmath>
#include <random>

#include "rig/session/image_file.h"
#include "tests/rig/session/png_parts.h"

namespace turnlight::rig {
namespace {

using testing::HasSubstr;

std::string ProfileBytes(cmsHPROFILE profile) {
  cmsUInt32Number size = 0;
  cmsSaveProfileToMem(profile, nullptr, &size);
  std::string bytes(size, '\0');
  cmsSaveProfileToMem(profile, bytes.data(), &size);
  cmsCloseProfile(profile);
  return bytes;
}

std::string GammaProfile(double gamma) {
  const cmsCIExyY white{0.3127, 0.3290, 1.0};
  const cmsCIExyYTRIPLE primaries{{0.64, 0.33, 1.0}, {0.30, 0.60, 1.0}, {0.15, 0.06, 1.0}};
  cmsToneCurve* curve = cmsBuildGamma(nullptr, gamma);
  cmsToneCurve* curves[3] = {curve, curve, curve};
  const std::string bytes = ProfileBytes(cmsCreateRGBProfile(&white, &primaries, curves));
  cmsFreeToneCurve(curve);
  return bytes;
}

std::string GreyPng(const std::string& chunk) {
  return WithChunk(PngOfRows(2, 1, 8, 0, std::string("\0\x10\x20", 3)), chunk);
}

std::optional<TransferClaim> ClaimOfPng(const std::string& chunks) {
  const auto picture = DecodePicture(GreyPng(chunks), "a.png");
  EXPECT_TRUE(picture) << picture.error().text;
  return picture ? picture->claims.transfer : std::nullopt;
}

std::string IccChunk(const std::string& profile) {
  return PngChunk("iCCP", std::string("name\0\0", 6) + Deflated(profile));
}

TEST(PictureClaims, OfPngChunks) {
  EXPECT_FALSE(ClaimOfPng(""));
  EXPECT_EQ(ClaimOfPng(PngChunk("sRGB", std::string(1, '\0')))->kind, Transfer::kSrgb);
  const auto gamma = ClaimOfPng(PngChunk("gAMA", BigEndian(45455)));
  EXPECT_EQ(gamma->kind, Transfer::kGamma);
  EXPECT_NEAR(gamma->gamma, 2.2, 1e-3);
  EXPECT_EQ(ClaimOfPng(PngChunk("gAMA", BigEndian(100000)))->kind, Transfer::kLinear);
  EXPECT_EQ(ClaimOfPng(PngChunk("cICP", std::string("\x01\x08\0\x01", 4)))->kind,
            Transfer::kLinear);
  EXPECT_EQ(ClaimOfPng(PngChunk("eXIf", ExifOf(0x0112, 1))), std::nullopt);
}

TEST(PictureClaims, TheStrongestChunkIsBelieved) {
  const std::string all = PngChunk("gAMA", BigEndian(100000)) + PngChunk("sRGB", std::string(1, 0));
  EXPECT_EQ(ClaimOfPng(all)->kind, Transfer::kSrgb);
  EXPECT_EQ(ClaimOfPng(all + PngChunk("cICP", std::string("\x01\x08\0\x01", 4)))->kind,
            Transfer::kLinear);
  // A code that says nothing leaves it to the others.
  EXPECT_EQ(ClaimOfPng(all + PngChunk("cICP", std::string("\x01\x02\0\x01", 4)))->kind,
            Transfer::kSrgb);
}

TEST(PictureClaims, OfIccProfiles) {
  const auto srgb = ClaimOfPng(IccChunk(ProfileBytes(cmsCreate_sRGBProfile())));
  ASSERT_TRUE(srgb);
  EXPECT_EQ(srgb->kind, Transfer::kSrgb);
  EXPECT_THAT(srgb->said_by, HasSubstr("the ICC profile \"sRGB"));
  EXPECT_EQ(IccClaim(GammaProfile(1.0))->kind, Transfer::kLinear);
  const auto gamma = IccClaim(GammaProfile(1.8));
  EXPECT_EQ(gamma->kind, Transfer::kGamma);
  EXPECT_NEAR(gamma->gamma, 1.8, 0.01);
}

TEST(PictureClaims, HostileOnesSayNothingAndDoNoHarm) {
  for (const std::string chunk : {"cICP", "iCCP", "sRGB", "gAMA", "eXIf"})
    for (std::size_t length = 0; length < 40; ++length)
      EXPECT_TRUE(DecodePicture(GreyPng(PngChunk(chunk, std::string(length, '\x09'))), "a.png"));
  EXPECT_FALSE(ClaimOfPng(PngChunk("gAMA", BigEndian(0))));
  EXPECT_FALSE(ClaimOfPng(PngChunk("gAMA", BigEndian(0xffffffff))));
  EXPECT_FALSE(ClaimOfPng(IccChunk(std::string(std::size_t{1} << 26, '\0'))));  // a bomb
  const std::string good = ProfileBytes(cmsCreate_sRGBProfile());
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::string bad = good.substr(0, i % 2 == 0 ? good.size() : random() % good.size());
    for (int k = 0; k < 4 && !bad.empty(); ++k)
      bad[random() % bad.size()] = static_cast<char>(random());
    const auto claim = IccClaim(bad);
    EXPECT_TRUE(!claim || std::isfinite(claim->gamma));
    ReadExif(bad);
  }
}

TEST(PictureClaims, OfCurves) {
  std::vector<double> line, power, step;
  for (int i = 0; i <= 32; ++i) {
    line.push_back(i / 32.0);
    power.push_back(std::pow(i / 32.0, 2.6));
    step.push_back(i < 16 ? 0.0 : 1.0);
  }
  EXPECT_EQ(CurveClaim(line, "").kind, Transfer::kLinear);
  EXPECT_EQ(CurveClaim(power, "").kind, Transfer::kGamma);
  EXPECT_NEAR(CurveClaim(power, "").gamma, 2.6, 0.01);
  EXPECT_EQ(CurveClaim(step, "").kind, Transfer::kOther);
}

TEST(PictureClaims, ContradictOnlyWhatDiffers) {
  calib::Radiometry linear, srgb, gamma, curve;
  srgb.encoding = calib::Encoding::kSrgb;
  gamma.encoding = calib::Encoding::kGamma;
  gamma.gamma = 1.8;
  curve.encoding = calib::Encoding::kCurve;
  const TransferClaim is_linear = GammaClaim(0.98, ""), is_srgb{Transfer::kSrgb, 2.2, ""};
  const TransferClaim is_22 = GammaClaim(0.45455, ""), is_18 = GammaClaim(0.5556, "");
  const TransferClaim other{Transfer::kOther, 2.0, ""};
  const auto all = [&](const calib::Radiometry& radiometry) {
    std::string out;
    for (const TransferClaim& claim : {is_linear, is_srgb, is_22, is_18, other})
      out += Contradicts(claim, radiometry) ? '!' : '.';
    return out;
  };
  EXPECT_EQ(all(linear), ".!!!!");
  EXPECT_EQ(all(srgb), "!..!!");
  EXPECT_EQ(all(gamma), "!!!.!");
  gamma.gamma = 2.2;
  EXPECT_EQ(all(gamma), "!..!!");
  EXPECT_EQ(all(curve), ".....");
}

TEST(PictureClaims, TurnedPicturesAreRefusedInWords) {
  for (int orientation = 2; orientation <= 8; ++orientation) {
    const auto picture =
        DecodePicture(GreyPng(PngChunk("eXIf", ExifOf(0x0112, orientation))), "a.png");
    ASSERT_FALSE(picture) << orientation;
    EXPECT_THAT(picture.error().text,
                testing::AllOf(HasSubstr("a.png: a turned picture: the eXIf chunk gives the "
                                         "orientation " +
                                         std::to_string(orientation)),
                               HasSubstr("to be shown"), HasSubstr("export them unturned")));
  }
  EXPECT_FALSE(DecodeMask(GreyPng(PngChunk("eXIf", ExifOf(0x0112, 3))), "a.png"));
}

}  // namespace
}  // namespace turnlight::rig
