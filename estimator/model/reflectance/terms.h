// What a lobe and a diffuse model are functions of, and what they give. Arithmetic is a template
// argument M, so that the same lines serve the kernel's lanes, a renderer's doubles and a test's
// automatic derivatives. M has
//   V                        a number, or several side by side
//   Splat(double)            a constant
//   Max, Min, Sqrt           of V
//   LogOneMinus(c)           log(1 - c), c in [0, 1)
//   ExpNegative(x)           exp(x), x <= 0; 0 where that is smaller than anything that matters
// and `condition ? a : b` must choose element by element. Nothing else is called here: a function
// of a library might be linked for another processor (see solve/kernel).
#pragma once

namespace turnlight::estimator::model::reflectance {

// A lobe's arguments. `axis` is what it is about: the mirrored view for a lobe about that, else the
// normal; what is compared with it is the direction to the light, or the half vector.
template <typename M>
struct LobeArguments {
  using V = typename M::V;
  V below_one;     // 1 - axis . (light or half vector), from the chord, as that is exact near 0
  V light_cosine;  // n . l
  V view_cosine;   // n . v, above 0
  V half_cosine;   // v . h; a lobe about the mirrored view does not read it
  V weight;        // what the term is multiplied by
};

// The term f_s and its derivatives.
template <typename M>
struct LobeTerm {
  using V = typename M::V;
  V value;
  V by_cosine;        // by axis . (light or half vector)
  V by_light_cosine;  // by n . l itself
  V by_half_cosine;   // by v . h
  V by_shape;         // by the shape itself; parameters.h steps in its logarithm
  V by_f0;            // 0 of a lobe that is not physical
};

// What a lobe has besides its formula.
struct LobeFacts {
  const char* word;       // in files and options
  const char* name;       // in sentences
  const char* shape_key;  // of its shape in files: "shininess" or "alpha"
  double least_shape, most_shape;
  bool about_mirrored_view;  // else about the normal: mirrored rays turn twice as fast
  bool physical;             // D F G / (4 n.v): has F0, and reflects at most what it gets
  bool cosine_power;         // cos^shape, 1 at its peak: its strength is the peak; else its energy
                             // hardly depends on its shape
};

template <typename M>
struct DiffuseArguments {
  using V = typename M::V;
  V light_cosine, view_cosine;  // n . l and n . v
  V projected;                  // l . v - (n . l) (n . v): of l and v within the surface's plane
};

// The term f_d, its derivative by what its shape is fitted as (Oren-Nayar: sigma^2), and its
// gradient by l, which is along_normal n + along_view v. A model says by kAlongView whether there
// is a part along v; where there is none, `projected` is not worked out either.
template <typename M>
struct DiffuseTerms {
  using V = typename M::V;
  V value, by_shape, along_normal, along_view;
};

struct DiffuseFacts {
  const char* word;
  const char* name;
  bool has_shape;  // Oren-Nayar's roughness
};

// Of the shape, worked out once for a scene: at most so many.
inline constexpr int kDiffuseConstants = 4;

}  // namespace turnlight::estimator::model::reflectance
