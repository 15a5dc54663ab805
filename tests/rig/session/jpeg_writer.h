// JPEG files for tests, written by libjpeg.
#pragma once

#include <cstdio>
// After cstdio, whose FILE it uses.
#include <jpeglib.h>

#include <cstdlib>
#include <opencv2/core.hpp>
#include <string>

namespace turnlight::rig {

// image: CV_8U, or R, G, B. orientation: written as EXIF if it is not 0.
inline std::string WriteJpeg(const cv::Mat& image, int orientation = 0, bool progressive = false) {
  jpeg_compress_struct jpeg;
  jpeg_error_mgr errors;
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = static_cast<unsigned>(image.cols);
  jpeg.image_height = static_cast<unsigned>(image.rows);
  jpeg.input_components = image.channels();
  jpeg.in_color_space = image.channels() == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 98, TRUE);
  if (progressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  if (orientation != 0) {
    std::string exif("Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0", 24);
    exif += std::string{static_cast<char>(orientation), 0, 0, 0, 0, 0, 0, 0};
    jpeg_write_marker(&jpeg, JPEG_APP0 + 1, reinterpret_cast<const JOCTET*>(exif.data()),
                      static_cast<unsigned>(exif.size()));
  }
  for (int row = 0; row < image.rows; ++row) {
    auto* line = const_cast<unsigned char*>(image.ptr(row));
    jpeg_write_scanlines(&jpeg, &line, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::string written(reinterpret_cast<char*>(bytes), size);
  jpeg_destroy_compress(&jpeg);
  std::free(bytes);
  return written;
}

}  // namespace turnlight::rig
