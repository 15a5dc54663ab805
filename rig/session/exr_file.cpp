// OpenEXR by its own library, from and to memory: OpenCV's reader neither tells channels apart nor
// reports what is damaged.
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfVersion.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "base/format.h"
#include "rig/session/image_formats.h"

namespace turnlight::rig {
namespace {

class MemoryReader : public Imf::IStream {
 public:
  MemoryReader(const std::string& bytes, const std::string& file)
      : Imf::IStream(file.c_str()), bytes_(bytes) {}

  bool read(char* out, int count) override {
    if (count < 0 || position_ > bytes_.size() ||
        static_cast<std::size_t>(count) > bytes_.size() - position_)
      throw std::runtime_error("the file ends too early");
    std::memcpy(out, bytes_.data() + position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::size_t>(count);
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  const std::string& bytes_;
  std::size_t position_ = 0;
};

class MemoryWriter : public Imf::OStream {
 public:
  MemoryWriter() : Imf::OStream("memory") {}

  void write(const char* data, int count) override {
    const std::size_t end = position_ + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end, '\0');
    std::memcpy(bytes_.data() + position_, data, static_cast<std::size_t>(count));
    position_ = end;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::size_t position_ = 0;
};

// Takes the text up to the next zero byte.
Result<std::string_view> TakeWord(std::string_view& rest, const std::string& file) {
  const std::size_t end = rest.find('\0');
  if (end == std::string_view::npos) return InputError(file + ": truncated OpenEXR header");
  const std::string_view word = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  return word;
}

// The library takes memory for an attribute before it looks whether the file is that long. Walks
// the header's name, type, size, value quadruples first.
Status CheckAttributes(std::string_view rest, const std::string& file) {
  constexpr std::string_view kMagic("\x76\x2f\x31\x01", 4);
  if (!rest.starts_with(kMagic) || rest.size() < 8)
    return InputError(file + ": not an OpenEXR file: its first 4 bytes are not OpenEXR's");
  if (rest[4] != 2 || (rest[5] & ~0x06) != 0 || rest[6] != 0 || rest[7] != 0)
    return InputError(file + ": OpenEXR of version " + std::to_string(rest[4]) +
                      " or with deep data or several parts, allowed is a single flat picture of" +
                      " version 2");
  rest.remove_prefix(8);
  for (;;) {
    const auto name = TakeWord(rest, file);
    if (!name) return Forward(name);
    if (name->empty()) return {};
    const auto type = TakeWord(rest, file);
    if (!type) return Forward(type);
    std::uint32_t size = 0;
    for (int i = 0; i < 4 && rest.size() >= 4; ++i)
      size |= static_cast<std::uint32_t>(static_cast<unsigned char>(rest[i])) << 8 * i;
    if (rest.size() < 4 || size > rest.size() - 4)
      return InputError(file + ": truncated OpenEXR header: attribute " + std::string(*name) +
                        " is longer than the file");
    if (*type == "idmanifest" || *type == "stringvector")
      return InputError(file + ": OpenEXR attribute " + std::string(*name) + " of type " +
                        std::string(*type) + ", which is not read");
    rest.remove_prefix(4 + size);
  }
}

// The channels in the order they are stored in memory: R, G, B, or Y; of masks, A behind them.
Result<std::vector<std::string>> CheckChannels(const Imf::ChannelList& list,
                                               const std::string& file, PictureUse use) {
  std::vector<std::string> names;
  for (auto channel = list.begin(); channel != list.end(); ++channel) {
    names.emplace_back(channel.name());
    if (channel.channel().type == Imf::UINT || channel.channel().xSampling != 1 ||
        channel.channel().ySampling != 1)
      return InputError(file + ": OpenEXR channel " + channel.name() +
                        " is of whole numbers or sub-sampled, allowed are half and float");
  }
  std::vector<std::vector<std::string>> allowed{{"Y"}, {"R", "G", "B"}};
  if (use == PictureUse::kMask) allowed.insert(allowed.end(), {{"Y", "A"}, {"R", "G", "B", "A"}});
  for (const std::vector<std::string>& channels : allowed)
    if (std::is_permutation(names.begin(), names.end(), channels.begin(), channels.end()))
      return channels;
  return InputError(file + ": " + std::to_string(names.size()) + " OpenEXR channels (" +
                    Listed(names) + "), allowed are Y, and R, G, B" +
                    (use == PictureUse::kMask ? ", with or without A" : ""));
}

// Where the library reads or writes each channel of a CV_32F picture whose top-left pixel is the
// data window's. The library forms the address of pixel (0, 0), which may lie outside the picture.
Imf::FrameBuffer BufferOf(const cv::Mat& image, const Imath::Box2i& window,
                          const std::vector<std::string>& channels) {
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < channels.size(); ++c)
    buffer.insert(channels[c], Imf::Slice::Make(Imf::FLOAT, image.data + c * sizeof(float), window,
                                                image.elemSize(), image.step[0]));
  return buffer;
}

}  // namespace

Result<Picture> DecodeExr(const std::string& bytes, const std::string& file, cv::Size expected,
                          PictureUse use) {
  if (const Status status = CheckAttributes(bytes, file); !status) return Forward(status);
  MemoryReader stream(bytes, file);
  Imf::InputFile input(stream, 0);
  const Imath::Box2i window = input.header().dataWindow();
  if (window != input.header().displayWindow())
    return InputError(file + ": the OpenEXR data window differs from its display window, allowed" +
                      " is a whole picture");
  const auto channels = CheckChannels(input.header().channels(), file, use);
  if (!channels) return Forward(channels);
  const ImageHeader header{std::int64_t{window.max.x} - window.min.x + 1,
                           std::int64_t{window.max.y} - window.min.y + 1,
                           static_cast<std::int64_t>(channels->size() * 8 * sizeof(float))};
  const Status status = CheckImageHeader(header, file, expected, bytes.size());
  if (!status) return Forward(status);
  if (!input.isComplete()) return InputError(file + ": truncated OpenEXR: some rows are missing");
  cv::Mat image(static_cast<int>(header.height), static_cast<int>(header.width),
                CV_32FC(static_cast<int>(channels->size())));
  input.setFrameBuffer(BufferOf(image, window, *channels));
  input.readPixels(window.min.y, window.max.y);
  return Picture{std::move(image), {}};
}

Result<std::string> EncodeExr(const cv::Mat& image, const std::string& file) {
  if (image.depth() != CV_32F)
    return InputError(file + ": OpenEXR is written with 32-bit float, not this depth; use .png");
  Imf::Header header(image.cols, image.rows);
  header.compression() = Imf::ZIP_COMPRESSION;
  const std::vector<std::string> channels = image.channels() == 1
                                                ? std::vector<std::string>{"Y"}
                                                : std::vector<std::string>{"R", "G", "B"};
  for (const std::string& channel : channels)
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  MemoryWriter stream;
  {
    Imf::OutputFile output(stream, header, 0);
    output.setFrameBuffer(BufferOf(image, header.dataWindow(), channels));
    output.writePixels(image.rows);
  }
  return stream.Take();
}

}  // namespace turnlight::rig
