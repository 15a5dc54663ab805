// A small valid session in a temporary folder, for tests to break.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>

#include "base/file.h"
#include "calib/camera_model.h"
#include "rig/session/image_file.h"
#include "tests/temporary_folder.h"

namespace turnlight::rig {

constexpr int kWidth = 16;
constexpr int kHeight = 12;

// A picture with a different value in every channel of every pixel, over the type's whole range.
inline cv::Mat Pattern(int type, int width = kWidth, int height = kHeight) {
  cv::Mat image(height, width, type);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, image.depth() == CV_8U ? 256 : 65536);
  if (image.depth() == CV_32F) image.convertTo(image, -1, 1.0 / 65535.0, -0.1);
  return image;
}

inline bool SamePixels(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         cv::norm(a.reshape(1), b.reshape(1), cv::NORM_INF) == 0.0;
}

class SessionFixture : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(root() / "frames");
    const auto camera = calib::CameraModel::Pinhole(kWidth, kHeight, 20.0, 20.0, 7.5, 5.5);
    ASSERT_TRUE(WriteFileAtomic(root() / "camera.cameramodel", camera.ToString()));
    for (const char* name : {"frames/000.png", "frames/001.png"})
      ASSERT_TRUE(WriteImage(root() / name, Pattern(CV_16UC3)));
    ASSERT_TRUE(WriteImage(root() / "frames/mask.png", cv::Mat(kHeight, kWidth, CV_8U, 255)));
    const nlohmann::json pose = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, -300}};
    json_ = {{"format", "turnlight-session"},
             {"version", 1},
             {"name", "small"},
             {"length_unit", "mm"},
             {"camera", "camera.cameramodel"},
             {"radiometry", {{"encoding", "linear"}, {"black", 0}, {"white", 65535}}},
             {"target", {{"shape", "sphere"}, {"radius", 50.0}}}};
    for (const auto& [name, angle] : {std::pair("frames/000.png", 0.0), {"frames/001.png", 10.0}})
      json_["frames"].push_back({{"image", name},
                                 {"mask", "frames/mask.png"},
                                 {"angle_deg", angle},
                                 {"X_WC", pose},
                                 {"X_WT", pose}});
  }

  const std::filesystem::path& root() const { return folder_.path(); }
  void Put(const std::string& name, const std::string& bytes) {
    std::ofstream(root() / name, std::ios::binary) << bytes;
  }
  std::string Get(const std::string& name) { return ReadFile(root() / name).value_or(""); }
  void WriteJson() { Put("session.json", json_.dump()); }

  TemporaryFolder folder_;
  nlohmann::json json_;
};

}  // namespace turnlight::rig
