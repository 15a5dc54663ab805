// JPEG by libjpeg. Its errors jump over this file's frames, so that nothing with a destructor is
// made between setjmp and the last call.
#include "rig/session/jpeg_file.h"

#include <cstdio>
// After cstdio, whose FILE they use.
#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>
#include <cstring>
#include <exception>
#include <string_view>

#include "rig/session/image_formats.h"
#include "rig/session/picture_claims.h"

namespace turnlight::rig {
namespace {

constexpr int kMostPasses = 100;  // a progressive file has ten; each takes as long as the picture
constexpr unsigned kExifMarker = JPEG_APP0 + 1;

struct Reader {
  jpeg_decompress_struct jpeg;
  jpeg_error_mgr errors;
  jpeg_progress_mgr progress;
  std::jmp_buf back;
  char message[JMSG_LENGTH_MAX];
};

Reader& ReaderOf(j_common_ptr jpeg) { return *static_cast<Reader*>(jpeg->client_data); }

[[noreturn]] void JumpBack(j_common_ptr jpeg) {
  Reader& reader = ReaderOf(jpeg);
  reader.errors.format_message(jpeg, reader.message);
  std::longjmp(reader.back, 1);
}

// Warnings are of damage that libjpeg fills with grey: no measurement. Bytes between two markers
// are none.
void OnMessage(j_common_ptr jpeg, int level) {
  if (level < 0 && jpeg->err->msg_code != JWRN_EXTRANEOUS_DATA) JumpBack(jpeg);
}

void OnProgress(j_common_ptr jpeg) {
  if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMostPasses) return;
  Reader& reader = ReaderOf(jpeg);
  std::snprintf(reader.message, sizeof(reader.message), "more than %d passes", kMostPasses);
  std::longjmp(reader.back, 1);
}

void Begin(Reader& reader, const std::string& bytes) {
  reader.jpeg.err = jpeg_std_error(&reader.errors);
  reader.errors.error_exit = JumpBack;
  reader.errors.emit_message = OnMessage;
  reader.jpeg.client_data = &reader;
  jpeg_create_decompress(&reader.jpeg);
  reader.progress.progress_monitor = OnProgress;
  reader.jpeg.progress = &reader.progress;
  jpeg_mem_src(&reader.jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_save_markers(&reader.jpeg, kExifMarker, 0xFFFF);
}

// False with a message.
bool ReadHeader(Reader& reader, JpegChannels channels) {
  if (setjmp(reader.back) != 0) return false;
  jpeg_read_header(&reader.jpeg, TRUE);
  const bool colour = channels == JpegChannels::kAsStored && reader.jpeg.num_components == 3;
  reader.jpeg.out_color_space = colour ? JCS_RGB : JCS_GRAYSCALE;
  return true;
}

bool ReadRows(Reader& reader, unsigned char* rows, std::size_t step) {
  if (setjmp(reader.back) != 0) return false;
  jpeg_start_decompress(&reader.jpeg);
  while (reader.jpeg.output_scanline < reader.jpeg.output_height) {
    JSAMPROW row = rows + step * reader.jpeg.output_scanline;
    jpeg_read_scanlines(&reader.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&reader.jpeg);
  return true;
}

// The orientation in an EXIF marker's bytes; 1 if there is none.
int ExifOrientation(std::string_view exif) {
  constexpr std::string_view kBegin("Exif\0\0", 6);
  return exif.starts_with(kBegin) ? ReadExif(exif.substr(kBegin.size())).orientation : 1;
}

Result<JpegPicture> Decode(Reader& reader, const std::string& bytes, const std::string& file,
                           JpegChannels channels) {
  const auto damaged = [&] {
    return InputError(file + ": damaged or truncated JPEG: " + reader.message);
  };
  if (!ReadHeader(reader, channels)) return damaged();
  const auto& jpeg = reader.jpeg;
  const ImageHeader header{jpeg.image_width, jpeg.image_height, 8};
  if (const Status status = CheckImageHeader(header, file, {}, bytes.size()); !status)
    return Forward(status);
  if (jpeg.num_components != 1 && jpeg.num_components != 3)
    return InputError(file + ": a JPEG of " + std::to_string(jpeg.num_components) +
                      " channels, allowed are grey (1) and colour (3)");
  JpegPicture picture;
  for (auto* marker = jpeg.marker_list; marker != nullptr; marker = marker->next)
    if (picture.orientation == 1)
      picture.orientation = ExifOrientation(
          {reinterpret_cast<const char*>(marker->data), std::size_t{marker->data_length}});
  picture.image.create(static_cast<int>(jpeg.image_height), static_cast<int>(jpeg.image_width),
                       jpeg.out_color_space == JCS_RGB ? CV_8UC3 : CV_8UC1);
  if (!ReadRows(reader, picture.image.data, picture.image.step)) return damaged();
  return picture;
}

}  // namespace

Result<JpegPicture> DecodeJpeg(const std::string& bytes, const std::string& file,
                               JpegChannels channels) {
  if (!bytes.starts_with("\xff\xd8\xff"))
    return InputError(file + ": not a JPEG file: its first 3 bytes are not JPEG's");
  Reader reader{};
  Begin(reader, bytes);
  Result<JpegPicture> picture = InputError("");
  try {
    picture = Decode(reader, bytes, file, channels);
  } catch (const std::exception& error) {
    picture = InputError(file + ": " + error.what());
  }
  jpeg_destroy_decompress(&reader.jpeg);
  return picture;
}

}  // namespace turnlight::rig
