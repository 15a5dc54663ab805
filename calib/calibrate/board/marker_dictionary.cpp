#include "calib/calibrate/board/marker_dictionary.h"

#include <algorithm>
#include <cctype>

#include "base/format.h"

namespace turnlight::calib::calibrate::board {
namespace {

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

}  // namespace

// In the order of cv::aruco::PREDEFINED_DICTIONARY_NAME.
const std::vector<std::string>& MarkerDictionaryNames() {
  static const std::vector<std::string> kNames = {
      "4X4_50",        "4X4_100",        "4X4_250",       "4X4_1000",      "5X5_50",
      "5X5_100",       "5X5_250",        "5X5_1000",      "6X6_50",        "6X6_100",
      "6X6_250",       "6X6_1000",       "7X7_50",        "7X7_100",       "7X7_250",
      "7X7_1000",      "ARUCO_ORIGINAL", "APRILTAG_16h5", "APRILTAG_25h9", "APRILTAG_36h10",
      "APRILTAG_36h11"};
  return kNames;
}

Result<cv::Ptr<cv::aruco::Dictionary>> FindMarkerDictionary(const std::string& name) {
  std::string wanted = Lower(name);
  if (wanted.starts_with("dict_")) wanted = wanted.substr(5);
  if (wanted.starts_with("tag")) wanted = "april" + wanted;
  if (wanted.starts_with("apriltag") && !wanted.starts_with("apriltag_"))
    wanted.insert(std::string("apriltag").size(), "_");
  const auto& names = MarkerDictionaryNames();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (Lower(names[i]) == wanted) return cv::aruco::getPredefinedDictionary(static_cast<int>(i));
  return InputError("marker dictionary \"" + name + "\" is unknown (allowed: " + Listed(names) +
                    ")");
}

cv::Mat MarkerBits(const cv::aruco::Dictionary& dictionary, int id) {
  const int bits = dictionary.markerSize;
  cv::Mat all = cv::Mat::zeros(bits + 2, bits + 2, CV_8U);
  cv::aruco::Dictionary::getBitsFromByteList(dictionary.bytesList.rowRange(id, id + 1), bits)
      .copyTo(all(cv::Rect(1, 1, bits, bits)));
  return all;
}

}  // namespace turnlight::calib::calibrate::board
