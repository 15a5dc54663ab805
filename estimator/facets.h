// How coarse a mesh is for a highlight.
#pragma once

#include "calib/target_shape.h"

namespace turnlight::estimator {

// How far a mesh's normals turn across a facet, radians: the median, weighted by area, of the
// largest angle between the normals at a facet's corners, over the facets that turn at all. 0 if
// those are less than a tenth of the area.
double FacetTurn(const calib::MeshShape& mesh);

}  // namespace turnlight::estimator
