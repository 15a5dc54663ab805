#include <algorithm>
#include <string>
#include <utility>
#include <vector>

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

// The scenes of one kind. With those that gave no result, which are right in nothing.
struct LightKind {
  std::string name;
  std::vector<const Json*> records;
  std::size_t attempted = 0;

  LightKind(std::string of, const StudyFile& file, const std::vector<const Json*>& measured)
      : name(std::move(of)) {
    for (const Json* record : measured)
      if ((*record)["kind"] == name) records.push_back(record);
    for (const auto& [id, record] : file.records)
      if (id.ends_with("/" + name) && !record.contains("left_out")) ++attempted;
  }
  // That `key` has this value in.
  void AcceptThat(const char* key, bool value, const std::string& what, Summary& out) const {
    Accept(out, name + ": " + what,
           Of(records, [&](const Json& record) { return record[key] == value; }), attempted, 0.95);
  }
};

void AcceptLights(const LightKind& kind, Summary& out) {
  Accept(out, kind.name + ": number of lights right", Of(kind.records, Right), kind.attempted,
         0.95);
  std::size_t good = 0, all = 0;
  for (const Json* record : kind.records)
    for (const Quantity& quantity : Quantities(*record))
      if (quantity.name == "direction" && quantity.sigma) {
        ++all;
        good += quantity.Error() <= 3.0 * *quantity.sigma ? 1 : 0;
      }
  Accept(out, kind.name + ": directions within 3 sigma_total", good, all, 0.95);
}

}  // namespace

Summary SummariseLights(const StudyFile& file) {
  Summary out;
  const auto records = Measured(file, out.text);
  const LightKind white("white", file, records), coloured("coloured", file, records),
      flickering("flickering", file, records), warming("warming", file, records),
      field("light-field", file, records);
  white.AcceptThat("found_coloured", false, "called white", out);
  white.AcceptThat("found_changing", false, "called constant", out);
  white.AcceptThat("found_uneven", false, "ambient light called constant", out);
  for (const LightKind* kind : {&white, &coloured, &flickering, &warming, &field})
    AcceptLights(*kind, out);
  std::vector<const Json*> mixed = coloured.records;
  std::erase_if(mixed, [](const Json* record) { return (*record)["lights_true"] == 1; });
  Accept(out, "coloured, several: called coloured",
         Of(mixed, [](const Json& record) { return record["found_coloured"] == true; }),
         mixed.size(), 0.95);
  AcceptSum(coloured.records, "colours", "coloured: colours within 3 sigma", out);
  for (const LightKind* kind : {&flickering, &warming}) {
    kind->AcceptThat("found_changing", true, "found", out);
    AcceptSum(kind->records, "factors", kind->name + ": factors within 3 sigma", out);
  }
  field.AcceptThat("found_uneven", true, "found", out);
  AcceptSum(field.records, "harmonics", "light-field: harmonics within 3 sigma", out);
  for (const Json* record : records)
    if (!Right(*record)) out.text += SceneLine(*record);
  return out;
}

}  // namespace turnlight::studies
