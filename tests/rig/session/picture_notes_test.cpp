// Proves: what pictures say beside the session is told once for all frames, with the first file and
// how many there are, and nothing is told where they agree. Does not prove: what the parts find;
// the tests of claims and levels do.
#include "rig/session/picture_notes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;

PictureFacts FactsOf(const std::string& file, std::optional<TransferClaim> claim,
                     std::vector<std::string> remarks = {}) {
  return {file, {std::move(claim), std::move(remarks)}, {}};
}

TEST(PictureNotes, TellEachKindOnce) {
  const TransferClaim srgb{Transfer::kSrgb, 2.2, "the sRGB chunk"};
  const calib::Radiometry linear;
  const auto notes = PictureNotes(
      linear, {FactsOf("a.png", {}), FactsOf("b.png", srgb, {"read as grey"}),
               FactsOf("c.png", srgb), FactsOf("d.png", GammaClaim(1.0, "the gAMA chunk"))});
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_EQ(notes[0].code, "encoding-contradicted");
  EXPECT_THAT(notes[0].text,
              AllOf(HasSubstr("2 of 4 pictures, the first is b.png: the sRGB chunk"),
                    HasSubstr("in session.json says linear"), HasSubstr("\"encoding\": \"srgb\"")));
  EXPECT_EQ(notes[1].code, "pictures-read-as");
  EXPECT_EQ(notes[1].text, "1 of 4 pictures, the first is b.png: read as grey");
}

TEST(PictureNotes, AreEmptyWhereAllAgree) {
  calib::Radiometry srgb;
  srgb.encoding = calib::Encoding::kSrgb;
  EXPECT_TRUE(PictureNotes(srgb, {}).empty());
  EXPECT_TRUE(
      PictureNotes(srgb, {FactsOf("a.png", {}), FactsOf("b.png", GammaClaim(0.45, ""))}).empty());
}

TEST(PictureNotes, LevelsAreOfTheWholeSession) {
  PictureLevels levels{.whole = true,
                       .bits = 16,
                       .used_bits = 0xfff0,
                       .largest = 60000,
                       .distinct = 1000,
                       .channels = {{}}};
  calib::Radiometry radiometry;
  radiometry.white = 65535;
  const auto notes = PictureNotes(radiometry, {{"a.png", {}, levels}, {"b.png", {}, levels}});
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].code, "levels-doubtful");
  EXPECT_THAT(notes[0].text, HasSubstr("set \"saturation\": 65520"));
}

}  // namespace
}  // namespace turnlight::rig
