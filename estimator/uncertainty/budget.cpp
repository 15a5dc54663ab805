#include "estimator/uncertainty/budget.h"

namespace turnlight::estimator::uncertainty {

const BudgetWords& NoiseWords() {
  static const BudgetWords kWords{"noise", "noise of the pictures, and residuals that go together",
                                  "take more views, or average pictures"};
  return kWords;
}

const BudgetWords& HalvesWords() {
  static const BudgetWords kWords{"halves", "halves of the pictures that disagree",
                                  "look at the residual pictures: something there is in no model"};
  return kWords;
}

const BudgetWords& PixelsWords() {
  static const BudgetWords kWords{"pixels", "what a pixel averages over",
                                  "go nearer, or take a longer focal length"};
  return kWords;
}

const BudgetWords& EdgesWords() {
  static const BudgetWords kWords{"edges", "pixels near the edges of shadows",
                                  "go nearer, or take a longer focal length"};
  return kWords;
}

const BudgetWords& NormalsWords() {
  static const BudgetWords kWords{"normals", "normals of the target that are tilted or scattered",
                                  "use a smoother target or a better mesh, and register it again"};
  return kWords;
}

const BudgetWords& SurfaceWords() {
  static const BudgetWords kWords{"surface", "roughness and texture of the target's surface",
                                  "use a target of one material, seen from more sides"};
  return kWords;
}

const BudgetWords& LightsWords() {
  static const BudgetWords kWords{
      "lights", "lights that are no points, that are missing, or whose distance was left out",
      "use smaller lamps, and shield others"};
  return kWords;
}

const BudgetWords& HighlightsWords() {
  static const BudgetWords kWords{"highlights", "places of highlights, by 0.15 pixels",
                                  "go nearer, or take a longer focal length"};
  return kWords;
}

const BudgetWords& DistanceWords() {
  static const BudgetWords kWords{
      "distance", "distances of lights that are not known: 50 radii of the target or infinity",
      "put the lights further away, or use a smaller target"};
  return kWords;
}

const BudgetWords& EarlierWords() {
  static const BudgetWords kWords{"model", "what the model may have wrong, of the fit that decided",
                                  "look at the residual pictures: something there is in no model"};
  return kWords;
}

}  // namespace turnlight::estimator::uncertainty
