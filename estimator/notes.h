// What a reader of an estimate has to be told, each with a stable code.
#pragma once

#include "base/messages/messages.h"
#include "calib/target_shape.h"
#include "estimator/estimate.h"
#include "estimator/observe/usable.h"

namespace turnlight::estimator {

// A row of the table of messages as a note.
void AddNote(const std::string& id, const messages::Values& values, Estimate& out);

// Code "views-add-nothing"; of what the estimate holds.
void AddViewsNote(Estimate& out);

// The same, and "no-highlight", "grey", "distance-unknown", "not-converged".
void AddNotes(Estimate& out);

// Code "count-uncertain": noise (sigma of a value) may hide a light, few pixels may not show one,
// score tests call for one more or for two in the place of one (out.count), or a light is hardly
// worth its price (least_kept: in that). brightest: the 99.9 % quantile of the radiance. What the
// model leaves as such is no reason: it is there beside right counts, too.
void AddCountNotes(double noise, double brightest, double least_kept, Estimate& out);

// Code "unexplained": the residual is more than noise.
void AddUnexplainedNote(double noise, Estimate& out);

// Whether a residual (rms) is more than noise, and whether noise may hide lights.
bool Unexplained(double rms, double noise);
bool Noisy(double noise, double brightest);

// Code "photograph"; and "count-uncertain", if one of its lights is hardly worth its price, and
// if one that was dropped nearly is.
void AddPhotographNotes(const start::PhotographLights& lights, Estimate& out);

// Code "outliers", if there are so many that some may have been missed.
void AddOutliersNote(const observe::FlagCounts& counts, Estimate& out);

// Code "pixels-thinned", if not all of the usable pixels were kept.
void AddThinnedNote(const observe::Observations& kept, std::size_t usable, Estimate& out);
// Code "facets-coarse", if the target is a mesh that came without normals and its facets are larger
// than the highlight.
void AddFacetsNote(const calib::TargetShape& shape, Estimate& out);

}  // namespace turnlight::estimator
