// The reflectance models that there are. A new one is a file of its own and a word in a list here.
#pragma once

#include "estimator/model/reflectance/beckmann.h"
#include "estimator/model/reflectance/blinn_phong.h"
#include "estimator/model/reflectance/coated.h"
#include "estimator/model/reflectance/ggx.h"
#include "estimator/model/reflectance/lambert.h"
#include "estimator/model/reflectance/oren_nayar.h"
#include "estimator/model/reflectance/phong.h"

namespace turnlight::estimator::model::reflectance {

template <typename... Models>
struct List {
  static constexpr int kCount = sizeof...(Models);

  // Calls function with a value of the type that has this number; false if there is none.
  template <typename Function>
  static __attribute__((always_inline)) inline bool Visit(int number, Function function) {
    int i = 0;
    return ((i++ == number && (function(Models{}), true)) || ...);
  }
};

// By their numbers, which model::SpecularModel and model::DiffuseModel name.
using Lobes = List<Phong, BlinnPhong, Beckmann, Ggx>;
using DiffuseModels = List<Lambert, OrenNayar, Coated>;

}  // namespace turnlight::estimator::model::reflectance
