// The studies: what each one's scenes are, as jobs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "bench/studies/job_runner.h"
#include "rig/sim/synthetic_config.h"

namespace turnlight::studies {

// Scenes [begin, end) of a study.
struct Range {
  int begin = 0;
  int end = 0;
};

// Random scenes that an estimate without a hint must get right (random_scene.h).
std::vector<Job> RandomJobs(Range scenes);

// Eight lights as in Figs. 7 to 9 of Mashita et al.: three around the zenith, five lower down, over
// a ball and over a lump with hollows, from 20 and from 10 views, without noise and with 1 %. A
// scene is one arrangement: number 0 has the lights 5 m away and equally spaced, the others are
// turned, jittered by up to 5 degrees, 5 to 40 target radii away, with intensities in a ratio of up
// to 2.
std::vector<Job> EightJobs(Range arrangements);

// The random study's scenes, started by hand: each light's direction is turned by 10 to 70 degrees
// about a random axis across it; nothing else is given.
std::vector<Job> HandStartJobs(Range scenes);

// Random scenes with noise (0.2 to 1 %) and 1 to 4 lights, in pictures of 120 x 90, 20 draws of the
// noise each: how often the stated intervals hold the truth. Lumps are left out (their shape hangs
// on the seed of the noise). Scene i is the first that fits of the random scenes 10 i .. 10 i + 9.
std::vector<Job> CoverageJobs(Range scenes);

// Random scenes with at most 4 lights, each of them as it is (white, constant), with colours of 0.5
// to 1 in each channel, flickering by 5 %, warming up by 10 %, and in a light field with a
// tenth of the mean on its darkest side.
std::vector<Job> LightJobs(Range scenes);
// One of them: "white", "coloured", "flickering", "warming" or "light-field".
Result<rig::sim::SyntheticConfig> LightConfig(const std::string& kind, int scene);

// Random scenes made hard on purpose, so that numbers of lights come out wrong, each in one way: a
// light more within 1.5 half-widths of another's highlight, one of a thirtieth to a
// three-thousandth of the strongest, noise of 3 to 20 % of white, pictures 4 to 10 times smaller, a
// response that is another by a power of 1.03 to 1.3, a target 0.3 to 3 % of its radius elsewhere
// than said. What is judged is whether results say so.
std::vector<Job> HardJobs(Range scenes);

// The random study's scenes, the target said to be a ten-thousandth of its radius elsewhere:
// nothing may hang on that.
std::vector<Job> ShiftedJobs(Range scenes);

// One thing at a time taken to its extreme (extreme_cells.h).
std::vector<Job> ExtremeJobs();

// The sessions of a folder of data that were made or photographed elsewhere: all that have a
// truth.json. Each is estimated without a hint by the program's own function.
Result<std::vector<Job>> SessionJobs(const std::filesystem::path& data);

// Scenes [begin, end) of those of photographs.h that the folder of data gives, each without a hint
// by the program's own function, by the paper's method and by bench/peers/highlight_centroids.py.
// Sums are written to the folder `scratch`, one for each job while it runs.
Result<std::vector<Job>> PhotographJobs(const std::filesystem::path& data, Range scenes,
                                        const std::filesystem::path& scratch);

}  // namespace turnlight::studies
