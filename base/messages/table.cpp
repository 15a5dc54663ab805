// The rows. Refusals first, then notes by what they are about, then verdicts.
#include "base/messages/messages.h"

namespace turnlight::messages {
namespace {

constexpr Kind kRefusal = Kind::kRefusal;
constexpr Kind kNote = Kind::kNote;
constexpr Kind kVerdict = Kind::kVerdict;

// Too few pixels can be used. {used} {least} {on_target}, {count}: the pixels of the cause.
const std::vector<Row> kTooFewPixels = {
    {"empty-masks", kRefusal, "the masks let no pixel through",
     "{used} usable pixels, at least {least} are needed. The masks leave no pixel:",
     "check them; white, or any value but 0, is the target."},
    {"no-target-in-view", kRefusal, "no ray of a pixel that the masks let through meets the target",
     "{used} usable pixels, at least {least} are needed. No pixel shows the target:",
     "check the poses (X_WC, X_WT), the target's size and its unit of length, and the masks."},
    {"seen-from-behind", kRefusal,
     "most rays that meet the target meet a face from behind, or where its normal points away",
     "{used} usable pixels, at least {least} are needed. {share} % of what is seen of the target "
     "is seen from behind:",
     "the mesh is wound inwards, or its normals point inwards: turn its faces round; or the poses "
     "put the camera behind the target or inside it: check them and the unit of length. (A plane "
     "gets a second side by sides: 2.)"},
    {"not-numbers", kRefusal, "most target pixels are NaN or infinite",
     "{used} usable pixels, at least {least} are needed. {count} of {on_target} target pixels are "
     "no numbers (NaN or infinite):",
     "check what wrote the pictures."},
    {"clipped-by-setting", kRefusal,
     "most target pixels are above the saturation, and their values differ: a sensor clips at one",
     "{used} usable pixels, at least {least} are needed. {count} of {on_target} target pixels lie "
     "above radiometry's saturation, at values that differ; a sensor clips at one:",
     "set saturation (or white, where saturation is not given) to the value at which the sensor "
     "clips."},
    {"clipped", kRefusal, "most target pixels are clipped, at one value",
     "{used} usable pixels, at least {least} are needed. {count} of {on_target} target pixels are "
     "clipped:",
     "lower the exposure or the gain."},
    {"too-dark", kRefusal,
     "most target pixels are at the sensor's floor, and the bright ones are far below white",
     "{used} usable pixels, at least {least} are needed. {count} of {on_target} target pixels are "
     "lost in noise; bright ones reach {bright} of white:",
     "expose longer, check the lamp, and check that radiometry's black is not too high."},
    {"too-noisy", kRefusal,
     "most target pixels are at the sensor's floor, and the bright ones are near white",
     "{used} usable pixels, at least {least} are needed. {count} of {on_target} target pixels are "
     "lost in noise, though bright ones reach {bright} of white:",
     "lower the gain and lengthen the exposure by as much, or average several pictures of each "
     "pose; a longer exposure alone would soon clip."},
    {"too-oblique", kRefusal, "most target pixels are seen at a grazing angle",
     "{used} usable pixels, at least {least} are needed. {count} of {on_target} target pixels see "
     "the surface too obliquely:",
     "look at it more from the front."},
    {"too-small", kRefusal, "most target pixels are at the outline, or across creases",
     "{used} usable pixels, at least {least} are needed. {count} of {on_target} target pixels are "
     "at the outline or across a crease:",
     "move the camera closer, or use a smoother target."},
    {"too-few", kRefusal, "few pixels are usable, for no one reason",
     "{used} usable pixels, at least {least} are needed. Of {on_target} target pixels {saturated} "
     "are clipped, {lost} lost in noise, {edge} at the outline or too oblique, {outliers} unlike "
     "their neighbours:",
     "begin with the largest of these: a shorter exposure against clipping, a longer one against "
     "noise, a closer view, more from the front, against outlines."},
    {"too-few/so-far", kRefusal, "few pixels are usable yet, while a capture goes on",
     "{used} usable pixels so far, at least {least} are needed:",
     "the next pictures may bring them."},
};

// There are pixels, and they tell nothing of lights.
const std::vector<Row> kNoLight = {
    {"black", kRefusal, "every usable pixel is black",
     "every usable pixel is black (99.9 % at or below {bright} of white):",
     "check the lamp, the exposure and radiometry.black."},
    {"not-a-surface", kRefusal, "more than 35 % of the target's pixels are outliers",
     "{count} of {on_target} target pixels are unlike all around them:",
     "the pictures show something else than a surface, such as noise or bytes in the wrong order; "
     "check their format and the masks."},
    {"no-light/copies", kRefusal,
     "no light explains the pictures, and some are copies of others, at other poses",
     "no light explains the pictures, and {copies} of {views} are copies of others, value for "
     "value, at other poses:",
     "look for a buffer that was saved twice, or files that were copied."},
    {"no-light/from-behind", kRefusal,
     "no light explains the pictures, and more than a tenth of the target is seen from behind",
     "no light explains the pictures, and {behind} % of what is seen of the target is seen from "
     "behind:",
     "the mesh is wound inwards in part, or its normals point inwards; turn its faces round."},
    {"no-light/dark", kRefusal,
     "no light is found, and the noise could hide one in pictures far below white",
     "no light explains more of the pictures than ambient light does; their noise is {noise}, "
     "{share} % of the brightest radiance, and that is {bright} of white:",
     "expose longer, or check the lamp."},
    {"no-light/noisy", kRefusal,
     "no light is found, and the noise could hide one though the pictures are not far below white",
     "no light explains more of the pictures than ambient light does; their noise is {noise}, "
     "{share} % of the brightest radiance, and that is {bright} of white:",
     "lower the gain and lengthen the exposure by as much, or average several pictures of each "
     "pose; a longer exposure alone would soon clip."},
    {"no-light/unexplained", kRefusal,
     "no light is found, though the pictures vary by more than noise",
     "no light explains more of the pictures than ambient light does, though they vary by more "
     "than noise (residual rms {rms}, noise {noise}, brightest radiance {bright}):",
     "what varies does not go with the surface's orientation; check the poses, the masks and that "
     "the shape is that of the target (turnlight verify SESSION --model tries other poses)."},
    {"direction-unknown/flat", kRefusal,
     "the brightest light's direction is not known to 45 degrees, and all that is seen of the "
     "target faces one way",
     "the direction of the brightest light is not known to 45 degrees, for all of the surface that "
     "is seen faces within {spread} degrees of one direction:",
     "use a target that bends, or turn or tilt it between pictures, so that the lights shine on it "
     "from several sides."},
    {"direction-unknown/noisy", kRefusal,
     "the same, and the noise is more than 15 % of the brightest radiance",
     "the direction of the brightest light is not known to 45 degrees; the noise is {share} % of "
     "the brightest radiance:",
     "average several pictures of each pose, take more of them, or lower the gain and lengthen "
     "the exposure by as much."},
    {"direction-unknown", kRefusal, "the same, for another reason",
     "the direction of the brightest light is not known to 45 degrees (sigma {sigma}) from {views} "
     "with {pixels} usable pixels:",
     "take more pictures from other sides; if there are enough, check that the poses and the shape "
     "are those of the target."},
    {"paper-no-light", kRefusal,
     "--method paper, and no mirrored view direction lies within 90 degrees of up",
     "no pixel's mirrored view direction lies within 90 degrees of the plane's normal (of W's +z "
     "for other targets), so the paper's intensity map is empty:",
     "move the camera, or use --method lm."},
};

const std::vector<Row> kViews = {
    {"views-add-nothing/repeated", kNote, "views are alike within noise, at the same poses",
     "{distinct} of {views} views differ by more than noise; the others repeat a pose, and the "
     "sigmas are those of the distinct ones.",
     "To learn more, take pictures at other angles."},
    {"views-add-nothing/copies", kNote,
     "pictures at different poses have the same values bit for bit, though what they should show "
     "differs",
     "{distinct} of {views} views differ by more than noise; {copies} are copies of others, value "
     "for value, at other poses (the first: {pair}), and what is estimated from them is not to be "
     "trusted.",
     "Look for a buffer that was saved twice, or files that were copied."},
    {"views-add-nothing/unmoved", kNote,
     "pictures at different poses are alike within noise, and the model predicts that they differ",
     "{distinct} of {views} views differ by more than noise; the others (the first: {pair}) are "
     "alike though the model predicts differences of {predicted}, {times} times the noise.",
     "Check that the table turned and that each picture is of its own angle."},
    {"views-add-nothing", kNote,
     "pictures at different poses are alike within noise, and the model predicts no difference",
     "{distinct} of {views} views differ by more than noise; the others add nothing, and the "
     "sigmas are those of the distinct ones.",
     "A homogeneous body of revolution on the axis looks the same at every angle: use another "
     "target, tilt it, or move the camera."},
};

const std::vector<Row> kModel = {
    {"no-highlight", kNote, "the data do not call for a specular part", "No highlight was found:",
     "shininess is null, and the lights' directions and distances rest on diffuse shading alone."},
    {"grey", kNote, "the pictures have one channel, or three that are the same",
     "The pictures are grey:", "albedo and products repeat one value for R, G and B."},
    {"grey/colours", kNote, "colours of lights were asked for of such pictures",
     "Colours of lights were asked for (--model color=free), but the pictures have one channel,",
     "which shows none: all lights are white."},
    {"distance-unknown", kNote, "the data do not call for a finite distance of some light",
     "Lights with distance null are too far for the data to tell how far;",
     "with 95 % confidence they are farther than distance_min."},
    {"not-converged", kNote, "the solver ended at its limit of iterations",
     "The solver reached its limit of iterations.",
     "The values may not be the best fit yet, and their sigmas may be too small; turnlight "
     "estimate --initial with this result.json begins with these lights."},
    {"not-converged/not-finite", kNote, "the solver ended where the model is not finite",
     "The solver could not begin: the model is not finite at its start.",
     "The values are those of the start, not of a fit; if they came from --initial, check them."},
    {"not-converged/descent", kNote, "--method paper, and the descent ended at its limit",
     "The descent reached its limit of iterations.", "The lights may not be the best fit yet."},
    {"distance-brightness-equivalent", kNote, "--method paper",
     "The paper's lights have no intensity of their own: each is taken to be as bright as one that "
     "gives the irradiance 1 from the distance {distance} (--ceiling-distance, in the session's "
     "unit).",
     "Distances and positions are those of such a light, not metric."},
    {"sigma-none", kNote, "--method paper",
     "The paper's method states no uncertainty: sigmas, distance_min and "
     "identifiability/condition are null.",
     "Directions are those of the intensity map's clusters and are not refined."},
    {"count-uncertain/noise", kNote, "the noise is more than 15 % of the brightest radiance",
     "The noise is {noise}, {share} % of the brightest radiance:",
     "lights and highlights may be hidden in it; average several pictures of each pose, or lower "
     "the gain and lengthen the exposure by as much."},
    {"count-uncertain/few-pixels", kNote, "fewer than 300 pixels are usable",
     "Only {pixels} pixels are usable:",
     "they may not show every light; take more pictures, or move the camera closer."},
    {"count-uncertain/further", kNote, "one more light would explain what is left, by 5 sigma",
     "One more light, from about {direction}, would explain something of what is left, by {sigmas} "
     "times what chance does:",
     "there may be one, or a shadow or a property of the surface that is in no model; look there, "
     "shield what you find, or compare with --model lights=N, N being one more."},
    {"count-uncertain/split", kNote,
     "two lights in the place of one would explain what is left, by 5 sigma",
     "Light {light} may be two close together, or an extended one: that would explain something "
     "of what is left, by {sigmas} times what chance does:",
     "look at the lamp; use smaller ones, or compare with --model lights=N, N being one more."},
    {"count-uncertain/hardly-kept", kNote,
     "a light that was kept is worth less than 1.3 of its price",
     "The evidence for a light that was kept is {kept} times what is asked for one:",
     "that is hardly enough, and it may not be there; take views from more sides, or compare with "
     "--model lights=N, N being one fewer."},
    {"count-uncertain/nearly-kept", kNote,
     "of a photograph: a light that was left out is worth more than 0.7 of its price",
     "The evidence for a light that was left out is {dropped} times what is asked for one:",
     "that is nearly enough, and there may be one more; look at the residual pictures "
     "(residual_NNN.png), take views from more sides, or compare with --model lights=N, N being "
     "one more."},
    {"unexplained", kNote, "the residual is more than twice the noise",
     "The model leaves {rms} rms of the pictures unexplained, {times} times their noise:",
     "a shadow or a property of the surface may be missing, or poses or the response may be wrong; "
     "the residual pictures (residual_NNN.png) show where, and turnlight verify SESSION --model "
     "tries other poses."},
    {"photograph", kNote,
     "no usual model explains the pictures down to their noise, and there are highlights",
     "There are highlights, but no usual model of a surface explains the pictures down to their "
     "noise; what is left unexplained is {misfit} times what is expected of photographs of real "
     "surfaces:",
     "lights were found by their highlights, and sigmas allow for it."},
    {"outliers", kNote, "0.5 % of the target's pixels or more are outliers",
     "{count} of {on_target} target pixels are unlike all around them and were left out;",
     "look at the pictures for broken pixels, dust or damaged data; some may have been missed."},
    {"exposure", kNote, "the brightest radiance is far from white",
     "The brightest radiance is about {level} of white; the numbers in the reasons of decisions "
     "are shares of it, not of white.",
     "If the pictures do not look so dark or so bright, check radiometry's white."},
    {"not-determined", kNote,
     "values whose sigma says that nothing is known of them: they are null",
     "The data do not determine {list}: their sigmas allow any value, and they are null.",
     "More pictures, from other sides, or less noise would tell them."},
    {"not-determined/no-light", kNote, "the same, and no light was found",
     "The data do not determine {list}, and they are null:", "there is no light to see them by."},
    {"light-left-out", kNote,
     "the direction of a light, not of the brightest, is not known to 45 degrees",
     "{lights} left out of the list, with a direction that is not known to 45 degrees; the "
     "residual is that of the fit before they were left out.",
     "--model lights=N decides how many there are."},
    {"null-distance-min", kNote, "a light's distance has no bound",
     "distance_min is null for light {lights}:",
     "the data do not tell how far it is at least; it may be near or far."},
    {"null-intensity-sigma", kNote, "there is a light", "intensity_sigma is null for light 1:",
     "the strongest light's intensity is 1 by definition; the sigmas of products do not depend on "
     "that."},
    {"null-condition", kNote, "the normal equations are singular",
     "identifiability/condition is null:",
     "the pictures leave some combination of the values open (the normal equations are singular); "
     "pictures from more sides would tell it."},
    {"null-sigma", kNote, "the data do not determine sigmas",
     "The data do not determine the sigma of {list}.",
     "Nothing says how far those values can be trusted; pictures from more sides may tell."},
};

const std::vector<Row> kFrames = {
    {"frames-left-out", kNote,
     "frames do not belong to the others (docs/estimation.md, section 13)",
     "{odd} of {frames} frames do not belong to the others and are left out: {list}.",
     "Mend or remove them; --frames chooses frames by hand."},
    {"frames-odd", kNote, "the same, and the frames were chosen by hand",
     "{odd} of {frames} frames do not belong to the others, but were chosen by hand: {list}.",
     "If that was not meant, leave them out of --frames."},
    {"poses-doubtful", kNote,
     "a change of all poses explains at least half of the residual, and at most 3 % of the "
     "brightest radiance is left",
     "{change} the residual falls from {before} to {after} of white:",
     "{question}{alike} The poses were left as they are."},
    {"poses-doubtful/unseen", kNote,
     "the poses as they are show hardly anything of the target, and a change of all of them "
     "explains the pictures",
     "{change} the target is seen, with a residual of {after} of white:",
     "{question}{alike} The poses were left as they are."},
    {"pixels-thinned", kNote, "more pixels of the target are usable than are held in memory",
     "{used} of about {usable} usable pixels were used, in blocks of {side} x {side} spread evenly "
     "over the pictures:",
     "--pixels sets how many are held in memory."},
    {"facets-coarse", kNote,
     "a mesh came without normals, and those made from its faces turn by more across a facet than "
     "the highlight is wide",
     "The mesh came without normals, and those made from its faces turn by {turn} degrees across a "
     "facet, more than the highlight is wide ({highlight} degrees of the normal): shininess and "
     "lights may be those of the facets, not of the surface.",
     "Use a finer mesh, or one with normals."},
};

const std::vector<Row> kCapture = {
    {"closure-clipped", kVerdict,
     "nothing of the two pictures can be compared, and more than a quarter of one is clipped",
     "the pictures cannot be compared, {share} % of one is clipped;",
     "lower the exposure or the gain, and capture again"},
    {"closure-dark", kVerdict, "nothing of the two pictures is bright enough to be compared",
     "the pictures are too dark to be compared, bright pixels reach {bright} of white;",
     "expose longer or check the lamp, and capture again"},
    {"closure-closed", kVerdict, "the closure frame is the first one, within noise or tolerance",
     "the picture at {closure}\u00b0 differs from the one at {first}\u00b0 by {share} %, {sigmas} "
     "times what noise explains;",
     "the table kept its place"},
    {"closure-open", kVerdict,
     "the closure frame differs from the first by more than noise and more than matters",
     "the picture at {closure}\u00b0 differs from the one at {first}\u00b0 by {share} %, {sigmas} "
     "times what noise explains; allowed is {most_share} % or {most_sigmas} times:",
     "the table lost its place, the target moved or the light changed; check these and capture "
     "again, for the angles of this capture are not to be trusted"},
};

const std::vector<Row> kNextView = {
    {"next-view", kVerdict, "a view would make the least known direction better known",
     "The least known direction is that of light {light}, to {sigma}\u00b0; with one more view, "
     "{view}, the least known one would be known to {predicted}\u00b0.",
     ""},
    {"next-view/reachable", kVerdict, "a sigma is wanted that further views are predicted to reach",
     "{views} would reach {wanted}\u00b0.", ""},
    {"next-view/unreachable-floor", kVerdict,
     "they are not, and most of the sigma does not shrink with views",
     "{wanted}\u00b0 are out of reach: with {views} it would be {then}\u00b0, and {floor}\u00b0 of "
     "it stay whatever is taken, most of that from {cause}:",
     "{advice}."},
    {"next-view/unreachable", kVerdict, "they are not, and most of the sigma is noise",
     "{wanted}\u00b0 are out of reach of these views: with {views} it would be {then}\u00b0.",
     "Expose longer, average pictures, or go nearer."},
    {"next-view/floor", kVerdict,
     "no view makes the least known direction better known, and most of its sigma does not "
     "shrink with views",
     "More views do not help: of the {sigma}\u00b0 to which the least known direction, that of "
     "light {light}, is known, {floor}\u00b0 stay whatever is taken, most of that from {cause}:",
     "{advice}."},
    {"next-view/none", kVerdict, "no view does, or there is none to choose from",
     "None of the views to choose from makes the least known direction, that of light {light} "
     "with {sigma}\u00b0, better known.",
     "Take some from other sides, or go nearer."},
    {"next-view/no-forecast", kVerdict,
     "the sigmas of the estimate are not those of a fit whose information adds up",
     "What a further view would tell cannot be predicted: {why}.", ""},
};

const std::vector<Row> kUntil = {
    {"until/early", kVerdict,
     "before the end of the plan, every direction was known well enough in all estimates over a "
     "quarter turn, and the lights stayed where they were",
     "Every light's direction has been known to {wanted}\u00b0 over the last {turned}\u00b0 of the "
     "turn:",
     "{taken} of {planned} keyframes are enough."},
    {"until/reached", kVerdict, "after the plan, every direction is known well enough",
     "After {taken} keyframes, {extra} more than planned, every light's direction is known to "
     "{wanted}\u00b0.",
     ""},
    {"until/one-more", kVerdict, "after the plan, a further view is predicted to help",
     "One more keyframe, {view}: the least known direction, that of light {light}, is known to "
     "{sigma}\u00b0, wanted are {wanted}\u00b0, and with it {predicted}\u00b0 are predicted.",
     ""},
    {"until/most-extra", kVerdict, "as many keyframes were added as the config allows",
     "{extra} more keyframes were taken, as many as capture/until/most_extra allows, and the least "
     "known direction, that of light {light}, is known to {sigma}\u00b0, not to {wanted}\u00b0:",
     "allow more, or take a longer exposure."},
    {"until/floor", kVerdict,
     "what does not shrink with views is more than what is wanted, or no view helps beside it and "
     "it is most of the sigma",
     "After {taken} keyframes the least known direction, that of light {light}, is known to "
     "{sigma}\u00b0, not to {wanted}\u00b0, and no number of them reaches that: {floor}\u00b0 "
     "of it stay whatever is taken, most of that from {cause}:",
     "{advice}."},
    {"until/no-view", kVerdict, "no further angle is predicted to help",
     "After {taken} keyframes the least known direction, that of light {light}, is known to "
     "{sigma}\u00b0, not to {wanted}\u00b0, and no further angle makes it better known:",
     "move the camera, or go nearer."},
    {"until/no-forecast", kVerdict, "the sigmas are not those of a fit whose information adds up",
     "After {taken} keyframes the least known direction, that of light {light}, is known to "
     "{sigma}\u00b0, not to {wanted}\u00b0, and what a further view would tell cannot be "
     "predicted: {why}.",
     ""},
    {"until/no-estimate", kVerdict, "there is no estimate of the planned keyframes",
     "After {taken} keyframes there is no estimate by which more could be chosen:",
     "the final estimate says why."},
};

std::vector<Row> Join() {
  std::vector<Row> all;
  for (const auto* part :
       {&kTooFewPixels, &kNoLight, &kViews, &kModel, &kFrames, &kCapture, &kNextView, &kUntil})
    all.insert(all.end(), part->begin(), part->end());
  return all;
}

}  // namespace

const std::vector<Row>& Table() {
  static const std::vector<Row> kTable = Join();
  return kTable;
}

}  // namespace turnlight::messages
