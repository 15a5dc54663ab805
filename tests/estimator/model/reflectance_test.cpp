// Proves: every lobe and diffuse model is the textbook's, and its derivatives are those of
// automatic differentiation, at random states and near the edges; a physical lobe reflects at most
// what it gets (the white furnace) and nearly all of it where it is smooth; it is reciprocal; half
// of the peak is left where the half-width says; one model converted to another is as wide and as
// bright. Does not prove that a model is a good one for any surface.
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "base/angles.h"
#include "estimator/model/reflectance/models.h"
#include "estimator/model/reflectance/scalar.h"
#include "tests/estimator/directions.h"
#include "tests/estimator/textbook_reflectance.h"

namespace turnlight::estimator::model {
namespace {

using Eigen::Vector3d;
using Jet = ceres::Jet<double, 5>;  // by l, shape and F0
using Numbers = reflectance::Scalar<double>;

constexpr SpecularModel kLobes[] = {SpecularModel::kPhong, SpecularModel::kBlinnPhong,
                                    SpecularModel::kBeckmann, SpecularModel::kGgx};
static_assert(std::size(kLobes) == reflectance::Lobes::kCount);

struct State {
  Vector3d n, l, v;
  double shape, f0;
};

// n.l and n.v of at least `least`.
State RandomState(std::uint64_t seed, SpecularModel model, double least) {
  const RandomStream random(seed, 5);
  State out;
  std::uint64_t draw = 0;
  do {
    out.n = RandomUnit(random, draw++);
    out.l = RandomUnit(random, draw++);
    out.v = RandomUnit(random, draw++);
  } while (out.n.dot(out.l) < least || out.n.dot(out.v) < least);
  const auto& facts = FactsOf(model);
  const double most = facts.physical ? 0.9 : 300.0, fewest = facts.physical ? 0.08 : 1.0;
  out.shape = std::exp(random.Uniform(1000, std::log(fewest), std::log(most)));
  out.f0 = random.Uniform(1001, 0.02, 1.0);
  return out;
}

// The term and its gradient, put together as the kernel does.
struct Analytic {
  double value, by_shape, by_f0;
  Vector3d by_light;
};

Analytic Evaluated(SpecularModel model, const State& at) {
  Analytic out{};
  reflectance::Lobes::Visit(static_cast<int>(model) - 1, [&](auto of) {
    using Model = decltype(of);
    const bool mirrored = Model::kFacts.about_mirrored_view;
    const double nl = at.n.dot(at.l), nv = at.n.dot(at.v);
    const Vector3d sum = at.l + at.v;
    const Vector3d half = mirrored ? at.l : sum.normalized();
    const Vector3d axis = mirrored ? Vector3d(2.0 * nv * at.n - at.v) : at.n;
    const double vh = at.v.dot(half);
    const auto term = Model::template Evaluate<Numbers>(
        at.shape, at.f0, {0.5 * (half - axis).squaredNorm(), nl, nv, vh, 1.0});
    const double scale = mirrored ? 1.0 : 1.0 / sum.norm();
    const auto across = [&](const Vector3d& to) {
      return mirrored ? to : Vector3d((to - half * to.dot(half)) * scale);
    };
    out = {term.value, term.by_shape, term.by_f0,
           across(axis) * term.by_cosine + at.n * term.by_light_cosine};
    if (!mirrored) out.by_light += across(at.v) * term.by_half_cosine;
  });
  return out;
}

Jet ByJets(SpecularModel model, const State& at) {
  textbook::Vector<Jet> l;
  for (int k = 0; k < 3; ++k) l[k] = Jet(at.l[k], k);
  // The textbook's formulas are of unit vectors.
  l = textbook::Vector<Jet>(l / sqrt(l.dot(l)));
  return textbook::Lobe(model, Jet(at.shape, 3), Jet(at.f0, 4),
                        textbook::Vector<Jet>(at.n.cast<Jet>()), l,
                        textbook::Vector<Jet>(at.v.cast<Jet>()));
}

void ExpectAlike(SpecularModel model, const State& at, double tolerance) {
  const Analytic analytic = Evaluated(model, at);
  const Jet jet = ByJets(model, at);
  const double size = std::abs(jet.a) + jet.v.norm() + 1e-12;
  EXPECT_NEAR(analytic.value, jet.a, tolerance * size);
  const Vector3d along = analytic.by_light - at.l * at.l.dot(analytic.by_light);
  EXPECT_LT((along - jet.v.head<3>()).norm(), tolerance * size);
  EXPECT_NEAR(analytic.by_shape, jet.v[3], tolerance * size);
  if (FactsOf(model).physical) {
    EXPECT_NEAR(analytic.by_f0, jet.v[4], tolerance * size);
  }
}

TEST(Lobes, AreTheTextbooksAndSoAreTheirDerivatives) {
  for (const SpecularModel model : kLobes)
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      SCOPED_TRACE(testing::Message() << FactsOf(model).word << " " << seed);
      const State at = RandomState(seed, model, 0.02);
      // Of nothing there is nothing to compare, and Phong's edge is a kink.
      if (ByJets(model, at).a < 1e-9) continue;
      ExpectAlike(model, at, 1e-8);
    }
}

TEST(Lobes, AreSmoothNearTheirEdges) {
  for (const SpecularModel model : kLobes)
    for (const double shape : {FactsOf(model).least_shape, FactsOf(model).most_shape}) {
      SCOPED_TRACE(testing::Message() << FactsOf(model).word << " " << shape);
      // Near the mirror, from above, aside and grazing (straight down the textbook divides by 0); a
      // little beside, by the lobe's own width.
      for (const double tilt_deg : {1.0, 40.0, 85.0}) {
        State at = RandomState(3, model, 0.1);
        at.shape = shape;
        const double off = 0.3 * std::min(LobeHalfWidth({model, 1.0, shape}), DegToRad(4.0));
        const double tilt = DegToRad(tilt_deg);
        at.n = Vector3d::UnitZ();
        at.l = {std::sin(tilt + off), 0.0, std::cos(tilt + off)};
        at.v = {-std::sin(tilt), 0.0, std::cos(tilt)};
        if (ByJets(model, at).a > 1e-9) ExpectAlike(model, at, 1e-4);
      }
    }
}

TEST(DiffuseModels, AreTheTextbooksAndSoAreTheirDerivatives) {
  for (int number = 0; number < reflectance::DiffuseModels::kCount; ++number)
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      const auto model = static_cast<DiffuseModel>(number);
      SCOPED_TRACE(testing::Message() << FactsOf(model).word << " " << seed);
      const State at = RandomState(seed, SpecularModel::kPhong, 0.02);
      const double roughness = 0.1 + 0.8 * at.f0;
      using DiffuseJet = ceres::Jet<double, 4>;
      textbook::Vector<DiffuseJet> l;
      for (int k = 0; k < 3; ++k) l[k] = DiffuseJet(at.l[k], k);
      const DiffuseJet jet =
          textbook::Diffuse(model, DiffuseJet(roughness * roughness, 3),
                            textbook::Vector<DiffuseJet>(at.n.cast<DiffuseJet>()), l,
                            textbook::Vector<DiffuseJet>(at.v.cast<DiffuseJet>()));
      reflectance::DiffuseModels::Visit(number, [&](auto of) {
        using Model = decltype(of);
        double constants[reflectance::kDiffuseConstants]{};
        Model::FillConstants(roughness, constants);
        const double nl = at.n.dot(at.l), nv = at.n.dot(at.v);
        const auto term =
            Model::template Evaluate<Numbers>(constants, {nl, nv, at.l.dot(at.v) - nl * nv});
        EXPECT_NEAR(term.value, jet.a, 1e-12);
        const Vector3d by_light = at.n * term.along_normal + at.v * term.along_view;
        EXPECT_LT((by_light - jet.v.head<3>()).norm(), 1e-10);
        EXPECT_NEAR(term.by_shape, jet.v[3], 1e-10);
      });
    }
}

// What a physical lobe sends to the viewer of a furnace that is white all over: the integral of
// f_s over the hemisphere, f_s having the factor n.l. masked: with the light's masking.
double Furnace(const Lobe& lobe, double view_deg, bool masked = true) {
  const double tilt = DegToRad(view_deg);
  const Vector3d v(std::sin(tilt), 0.0, std::cos(tilt));
  constexpr int kRings = 600, kSpokes = 600;
  double sum = 0.0;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kSpokes; ++j) {
      // Uniform in solid angle.
      const double z = (i + 0.5) / kRings, r = std::sqrt(1.0 - z * z);
      const double around = 2.0 * std::numbers::pi * (j + 0.5) / kSpokes;
      const Vector3d l(r * std::cos(around), r * std::sin(around), z);
      sum += SpecularTerm(lobe, Vector3d::UnitZ(), l, v) /
             (masked ? 1.0 : textbook::Mask(lobe.model, z, lobe.shape));
    }
  return sum * 2.0 * std::numbers::pi / (kRings * kSpokes);
}

TEST(PhysicalLobes, ReflectAtMostWhatTheyGet) {
  for (const SpecularModel model : {SpecularModel::kBeckmann, SpecularModel::kGgx})
    for (const double alpha : {0.15, 0.4, 0.8})
      for (const double view_deg : {0.0, 30.0, 60.0}) {
        SCOPED_TRACE(testing::Message() << FactsOf(model).word << " " << alpha << " " << view_deg);
        const double all = Furnace({model, 1.0, alpha, 1.0}, view_deg);
        EXPECT_LT(all, 1.0 + 2e-3);
        // What is lost was to be reflected more than once.
        EXPECT_GT(all, alpha < 0.2 ? 0.93 : 0.3);
        EXPECT_LT(Furnace({model, 1.0, alpha, 0.04}, view_deg), all);
      }
}

// Seen from above and without the light's masking it is the share of the facets that reflect into
// the upper hemisphere, those that are tilted by less than 45 degrees: in closed form.
TEST(PhysicalLobes, ReflectByEveryFacetOnce) {
  for (const double alpha : {0.15, 0.4, 0.8}) {
    EXPECT_NEAR(Furnace({SpecularModel::kGgx, 1.0, alpha, 1.0}, 0.0, false),
                1.0 / (1.0 + alpha * alpha), 2e-3);
    EXPECT_NEAR(Furnace({SpecularModel::kBeckmann, 1.0, alpha, 1.0}, 0.0, false),
                1.0 - std::exp(-1.0 / (alpha * alpha)), 2e-3);
  }
}

TEST(PhysicalLobes, AreReciprocal) {
  for (const SpecularModel model : {SpecularModel::kBeckmann, SpecularModel::kGgx})
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
      const State at = RandomState(seed, model, 0.05);
      const Lobe lobe{model, 1.0, at.shape, at.f0};
      // f_s over n.l is the distribution function.
      EXPECT_NEAR(SpecularTerm(lobe, at.n, at.l, at.v) / at.n.dot(at.l),
                  SpecularTerm(lobe, at.n, at.v, at.l) / at.n.dot(at.v), 1e-9);
    }
}

TEST(HalfWidth, IsWhereHalfOfThePeakIsLeft) {
  const Vector3d n = Vector3d::UnitZ();
  for (const SpecularModel model : kLobes) {
    const bool physical = FactsOf(model).physical;
    for (const double shape :
         physical ? std::vector{0.003, 0.05, 0.2} : std::vector{5.0, 100.0, 1e5}) {
      const Lobe lobe{model, 1.0, shape, 1.0};
      const double off = MirroredHalfWidth(lobe);
      // Light and viewer to both sides: masking acts on both alike, and little.
      const Vector3d l(std::sin(off), 0.0, std::cos(off));
      const double share = SpecularTerm(lobe, n, l, n) / SpecularTerm(lobe, n, n, n);
      EXPECT_NEAR(share, 0.5, physical ? 0.03 : 1e-6) << FactsOf(model).word << " " << shape;
    }
  }
}

TEST(Converted, IsAsWideAndAsBright) {
  const Lobe phong{SpecularModel::kPhong, 0.4, 200.0};
  for (const SpecularModel model : kLobes) {
    const Lobe other = Converted(phong, model);
    EXPECT_EQ(other.model, model);
    EXPECT_NEAR(LobePeak(other), 0.4, 1e-12) << FactsOf(model).word;
    EXPECT_NEAR(MirroredHalfWidth(other) / MirroredHalfWidth(phong), 1.0, 0.25);
    const Lobe back = Converted(other, SpecularModel::kPhong);
    EXPECT_NEAR(back.shape, phong.shape, 1e-9 * phong.shape);
    EXPECT_NEAR(back.strength, phong.strength, 1e-9);
  }
  EXPECT_EQ(Converted(phong, SpecularModel::kNone).strength, 0.0);
}

}  // namespace
}  // namespace turnlight::estimator::model
