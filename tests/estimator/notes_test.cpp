// Proves: each note is given when its reason is there, with its code and numbers, and not
// otherwise. Does not prove that the thresholds are the right ones: bench/studies does.
#include "estimator/notes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace turnlight::estimator {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> CodesOf(const Estimate& estimate) {
  std::vector<std::string> codes;
  for (const Note& note : estimate.notes) codes.push_back(note.code);
  return codes;
}

// Nothing to remark on.
Estimate Unremarkable() {
  Estimate estimate;
  estimate.views = estimate.distinct_views = 6;
  estimate.lights.emplace_back().near = true;
  estimate.pixels = 5000;
  estimate.rms = 0.01;
  return estimate;
}

TEST(Notes, NoneWhereThereIsNothingToSay) {
  Estimate estimate = Unremarkable();
  AddNotes(estimate);
  AddCountNotes(0.01, 0.8, 1.3, estimate);
  AddUnexplainedNote(0.01, estimate);
  AddOutliersNote({.on_target = 1000, .outliers = 5}, estimate);
  EXPECT_THAT(CodesOf(estimate), IsEmpty());
}

TEST(Notes, EachHasItsReason) {
  Estimate estimate = Unremarkable();
  estimate.distinct_views = 2;
  estimate.reflectance.lobes[0].model = model::SpecularModel::kNone;
  estimate.channels = 1;
  estimate.lights.emplace_back();
  estimate.stopped = solve::Stopped::kIterationLimit;
  AddNotes(estimate);
  EXPECT_THAT(CodesOf(estimate), ElementsAre("views-add-nothing", "no-highlight", "grey",
                                             "distance-unknown", "not-converged"));
  EXPECT_THAT(estimate.notes[0].text, HasSubstr("2 of 6 views differ by more than noise"));
}

TEST(Notes, NoConvergenceSaysWhy) {
  for (const auto& [stopped, words] :
       {std::pair{solve::Stopped::kIterationLimit, "limit of iterations"},
        std::pair{solve::Stopped::kNotFinite, "not finite"}}) {
    Estimate estimate = Unremarkable();
    estimate.stopped = stopped;
    AddNotes(estimate);
    ASSERT_THAT(CodesOf(estimate), ElementsAre("not-converged"));
    EXPECT_THAT(estimate.notes[0].text, HasSubstr(words));
  }
}

TEST(Notes, TheCountIsUncertainForFiveReasons) {
  const auto texts = [](Estimate estimate, double noise = 0.01, double least_kept = 1.3) {
    AddCountNotes(noise, 1.0, least_kept, estimate);
    std::string all;
    for (const Note& note : estimate.notes) all += note.code + ": " + note.text + "\n";
    return all;
  };
  EXPECT_THAT(texts(Unremarkable(), 0.16), HasSubstr("16 % of the brightest radiance"));
  EXPECT_THAT(texts(Unremarkable(), 0.01, 1.29),
              HasSubstr("count-uncertain: The evidence for a light that was kept is 1.3 times"));
  Estimate few = Unremarkable();
  few.pixels = 300;
  few.count.further = few.count.split = 5.0;
  EXPECT_EQ(texts(few), "");
  few.pixels = 299;
  EXPECT_THAT(texts(few), HasSubstr("Only 299 pixels are usable"));
  Estimate further = Unremarkable();
  further.count.further = 20.4;
  further.count.further_direction = {0.6, -0.8, 0.0};
  EXPECT_THAT(texts(further), HasSubstr("count-uncertain: One more light, from about (+0.6, -0.8, "
                                        "+0.0), would explain something of what is left, by 20"));
  Estimate split = Unremarkable();
  split.count.split = 7.1;
  split.count.split_light = 1;
  EXPECT_THAT(texts(split), HasSubstr("count-uncertain: Light 2 may be two close together"));
}

TEST(Notes, WhatIsLeftBeyondNoiseIsSaidAndNoReasonToDoubtTheCount) {
  Estimate unexplained = Unremarkable();
  unexplained.rms = 0.031;
  AddCountNotes(0.01, 1.0, 1.3, unexplained);
  AddUnexplainedNote(0.01, unexplained);
  ASSERT_THAT(CodesOf(unexplained), ElementsAre("unexplained"));
  EXPECT_THAT(unexplained.notes[0].text, HasSubstr("The model leaves 0.031 rms"));
  EXPECT_THAT(unexplained.notes[0].text, HasSubstr("3.1 times their noise"));
}

TEST(Notes, APhotographsCountIsUncertainForTwoReasons) {
  const auto notes = [](double least_kept, double most_dropped) {
    Estimate estimate = Unremarkable();
    start::PhotographLights lights;
    lights.misfit = 1.44;
    lights.least_kept = least_kept;
    lights.most_dropped = most_dropped;
    AddPhotographNotes(lights, estimate);
    return estimate;
  };
  const double none = std::numeric_limits<double>::infinity();  // no light beside the only one
  EXPECT_THAT(CodesOf(notes(none, 0.7)), ElementsAre("photograph"));
  EXPECT_THAT(notes(none, 0.0).notes[0].text, HasSubstr("unexplained is 1.2 times what"));
  const Estimate weak = notes(1.29, 0.7), strong = notes(1.3, 0.71);
  ASSERT_THAT(CodesOf(weak), ElementsAre("photograph", "count-uncertain"));
  EXPECT_THAT(weak.notes[1].text, HasSubstr("a light that was kept is 1.3 times what is asked"));
  ASSERT_THAT(CodesOf(strong), ElementsAre("photograph", "count-uncertain"));
  EXPECT_THAT(strong.notes[1].text, HasSubstr("that was left out is 0.71 times what is asked"));
  EXPECT_THAT(CodesOf(notes(1.29, 0.71)),
              ElementsAre("photograph", "count-uncertain", "count-uncertain"));
}

TEST(Notes, ThresholdsAreTheStatedOnes) {
  EXPECT_FALSE(Unexplained(0.02, 0.01));
  EXPECT_TRUE(Unexplained(0.0201, 0.01));
  EXPECT_FALSE(Noisy(0.15, 1.0));
  EXPECT_TRUE(Noisy(0.151, 1.0));
}

TEST(Notes, ManyOutliersAreCounted) {
  Estimate estimate = Unremarkable();
  AddOutliersNote({.on_target = 1000, .outliers = 17}, estimate);
  ASSERT_THAT(CodesOf(estimate), ElementsAre("outliers"));
  EXPECT_THAT(estimate.notes[0].text, HasSubstr("17 of 1000 target pixels"));
}

TEST(Notes, PixelsThatWereGivenUpAreCounted) {
  Estimate estimate = Unremarkable();
  observe::Observations kept;
  kept.used = 16'000'000;
  AddThinnedNote(kept, 16'000'000, estimate);
  EXPECT_THAT(CodesOf(estimate), IsEmpty());
  kept.blocks.share = 0.5;
  AddThinnedNote(kept, 31'000'000, estimate);
  ASSERT_THAT(CodesOf(estimate), ElementsAre("pixels-thinned"));
  EXPECT_THAT(estimate.notes[0].text, HasSubstr("16000000 of about 31000000 usable pixels"));
}

}  // namespace
}  // namespace turnlight::estimator
