#include "base/format.h"
#include "bench/studies/random_scene.h"
#include "bench/studies/studies.h"
#include "bench/studies/take.h"

namespace turnlight::studies {

std::vector<Job> RandomJobs(Range scenes) {
  std::vector<Job> jobs;
  for (int i = scenes.begin; i < scenes.end; ++i) {
    jobs.push_back({Format("random/%04d", i), [i] {
                      const auto config = RandomScene(static_cast<std::uint64_t>(i));
                      if (!config) return Json{{"left_out", config.error().text}};
                      return TakeAndScore(*config);
                    }});
  }
  return jobs;
}

}  // namespace turnlight::studies
