#include <algorithm>

#include "base/format.h"
#include "bench/studies/summary_parts.h"

namespace turnlight::studies {
namespace {

// Of the records of one kind, how many a condition holds for.
template <typename Condition>
std::size_t Of(const std::vector<const Json*>& records, const Condition& condition) {
  return static_cast<std::size_t>(std::count_if(
      records.begin(), records.end(), [&](const Json* record) { return condition(*record); }));
}

// A sum of the counts [good, all] under a key.
void AcceptSum(const std::vector<const Json*>& records, const char* key, const std::string& what,
               Summary& out) {
  std::size_t good = 0, all = 0;
  for (const Json* record : records) {
    good += (*record)[key][0].get<std::size_t>();
    all += (*record)[key][1].get<std::size_t>();
  }
  Accept(out, what, good, all, 0.95);
}

void AcceptDirections(const std::string& kind, const std::vector<const Json*>& records,
                      Summary& out) {
  std::size_t good = 0, all = 0;
  for (const Json* record : records)
    for (const Quantity& quantity : Quantities(*record))
      if (quantity.name == "direction" && quantity.sigma) {
        ++all;
        good += quantity.Error() <= 3.0 * *quantity.sigma ? 1 : 0;
      }
  Accept(out, kind + ": directions within 3 sigma_total", good, all, 0.95);
}

}  // namespace

Summary SummariseLights(const StudyFile& file) {
  Summary out;
  const auto records = Measured(file, out.text);
  const auto of_kind = [&](const char* kind) {
    std::vector<const Json*> chosen;
    for (const Json* record : records)
      if ((*record)["kind"] == kind) chosen.push_back(record);
    return chosen;
  };
  const auto said = [](const char* key, bool value) {
    return [key, value](const Json& record) { return record[key] == value; };
  };
  const auto white = of_kind("white"), coloured = of_kind("coloured"),
             flickering = of_kind("flickering"), warming = of_kind("warming"),
             field = of_kind("light-field");
  const auto several = [](std::vector<const Json*> of) {
    std::erase_if(of, [](const Json* record) { return (*record)["lights_true"] == 1; });
    return of;
  };
  Accept(out, "white: called white", Of(white, said("found_coloured", false)), white.size(), 0.95);
  Accept(out, "white: called constant", Of(white, said("found_changing", false)), white.size(),
         0.95);
  Accept(out, "white: ambient light called constant", Of(white, said("found_uneven", false)),
         white.size(), 0.95);
  for (const auto& [kind, of] : {std::pair("white", &white),
                                 {"coloured", &coloured},
                                 {"flickering", &flickering},
                                 {"warming", &warming},
                                 {"light-field", &field}}) {
    Accept(out, std::string(kind) + ": number of lights right", Of(*of, Right), of->size(), 0.95);
    AcceptDirections(kind, *of, out);
  }
  const auto mixed = several(coloured);
  Accept(out, "coloured, several: called coloured", Of(mixed, said("found_coloured", true)),
         mixed.size(), 0.95);
  AcceptSum(coloured, "colours", "coloured: colours within 3 sigma", out);
  Accept(out, "flickering: found", Of(flickering, said("found_changing", true)), flickering.size(),
         0.95);
  AcceptSum(flickering, "factors", "flickering: factors within 3 sigma", out);
  Accept(out, "warming: found", Of(warming, said("found_changing", true)), warming.size(), 0.95);
  AcceptSum(warming, "factors", "warming: factors within 3 sigma", out);
  AcceptSum(field, "harmonics", "light-field: harmonics within 3 sigma", out);
  out.text += Format("  light-field: said in %zu of %zu\n", Of(field, said("found_uneven", true)),
                     field.size());
  for (const Json* record : records)
    if (!Right(*record)) out.text += SceneLine(*record);
  return out;
}

}  // namespace turnlight::studies
